//! Envelope in scaled coordinates.

use envelope::Envelope;
use estimator::{FitError, Scaling};

/// Envelope in the coordinates s = t/span in 0..1 and x = ln A − mean. No line is fitted here, only a range,
/// a mean and a standard deviation. The logarithms keep their unit, because the terms of a law are
/// exponentials of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Scaled {
    /// Time from the first peak to the last, in seconds.
    pub span_s: f64,
    /// Mean of ln A.
    pub mean: f64,
    /// Standard deviation of ln A, with divisor n.
    pub spread: f64,
    /// s of every peak.
    pub times: Vec<f64>,
    /// x of every peak.
    pub logs: Vec<f64>,
}

impl Scaled {
    /// Scales an envelope.
    ///
    /// # Errors
    /// [`FitError::NoSpread`] as for [`Scaling::of`].
    pub fn of(envelope: &Envelope) -> Result<Self, FitError> {
        let scaling = Scaling::of(envelope)?;
        Ok(Self {
            span_s: scaling.duration(),
            mean: scaling.mean(),
            spread: scaling.spread(),
            times: scaling.unit_times(envelope),
            logs: envelope.log_amplitudes().iter().map(|log| log - scaling.mean()).collect(),
        })
    }

    /// Returns the number of peaks.
    pub fn peaks(&self) -> usize {
        self.times.len()
    }

    /// Returns the scaled times minus their mean.
    fn centered_times(&self) -> impl Iterator<Item = f64> + '_ {
        let mean = self.times.iter().sum::<f64>() / self.peaks() as f64;
        self.times.iter().map(move |time| time - mean)
    }

    /// Returns Σ(s − mean)² over the peaks, dimensionless. The variance of a slope is that of the residuals
    /// divided by it.
    pub fn squared_times(&self) -> f64 {
        self.centered_times().map(|time| time * time).sum()
    }

    /// Returns λ in 1/s of a function given by one value of x per peak: minus the slope of its least-squares
    /// line.
    pub fn decay_rate(&self, function: &[f64]) -> f64 {
        debug_assert_eq!(function.len(), self.peaks(), "one value a peak");
        let mean = function.iter().sum::<f64>() / self.peaks() as f64;
        let product: f64 = self.centered_times().zip(function).map(|(time, x)| time * (x - mean)).sum();
        -product / (self.squared_times() * self.span_s)
    }

    /// Returns the differences in x between the measured peaks and a function given at them, in the order of
    /// the peaks.
    pub fn residuals(&self, function: &[f64]) -> Vec<f64> {
        self.logs.iter().zip(function).map(|(log, x)| log - x).collect()
    }
}
