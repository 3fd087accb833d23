//! The envelope in scaled coordinates.

use envelope::Envelope;
use estimator::FitError;

/// s = t/span in 0..1 and x = ln A − mean: no line is fitted here, only a range, a mean and a standard
/// deviation. The logarithms keep their unit, because the terms of a law are exponentials of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Scaled {
    /// From the first peak to the last, in seconds.
    pub span_s: f64,
    /// Mean of ln A.
    pub mean: f64,
    /// Standard deviation of ln A.
    pub spread: f64,
    /// s of every peak.
    pub times: Vec<f64>,
    /// x of every peak.
    pub logs: Vec<f64>,
}

impl Scaled {
    /// The scaled envelope.
    ///
    /// # Errors
    /// [`FitError::NoSpread`] where ln A is the same at every peak.
    pub fn of(envelope: &Envelope) -> Result<Self, FitError> {
        let span_s = envelope.times_s().last().copied().unwrap_or_default();
        let logs = envelope.log_amplitudes();
        let count = logs.len() as f64;
        let mean = logs.iter().sum::<f64>() / count;
        let spread = (logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / count).sqrt();
        // Below this the logarithms differ by their rounding only.
        if !spread.is_finite() || spread <= 1e-13 * mean.abs().max(1.0) {
            return Err(FitError::NoSpread { spread });
        }
        Ok(Self {
            span_s,
            mean,
            spread,
            times: envelope.times_s().iter().map(|time| time / span_s).collect(),
            logs: logs.iter().map(|log| log - mean).collect(),
        })
    }

    /// Number of peaks.
    pub fn peaks(&self) -> usize {
        self.times.len()
    }

    /// Times after their mean.
    fn centered_times(&self) -> impl Iterator<Item = f64> + '_ {
        let mean = self.times.iter().sum::<f64>() / self.peaks() as f64;
        self.times.iter().map(move |time| time - mean)
    }

    /// Σ(s − mean)², what a slope's error is measured against.
    pub fn squared_times(&self) -> f64 {
        self.centered_times().map(|time| time * time).sum()
    }

    /// λ in 1/s of a function given at the peaks: minus the slope of its least-squares projection on a
    /// line.
    pub fn decay_rate(&self, function: &[f64]) -> f64 {
        let mean = function.iter().sum::<f64>() / self.peaks() as f64;
        let product: f64 = self.centered_times().zip(function).map(|(time, x)| time * (x - mean)).sum();
        -product / (self.squared_times() * self.span_s)
    }

    /// The differences between the measured x and a function.
    pub fn residuals(&self, function: &[f64]) -> Vec<f64> {
        self.logs.iter().zip(function).map(|(log, x)| log - x).collect()
    }
}
