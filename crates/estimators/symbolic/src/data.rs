//! The measured envelope in the coordinates that expressions work in.

use envelope::Envelope;
use estimator::{FitError, Scaling};

/// The peaks in scaled units: τ in 0..1 and z.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Data {
    pub(crate) scaling: Scaling,
    pub(crate) times: Vec<f64>,
    pub(crate) targets: Vec<f64>,
}

impl Data {
    pub(crate) fn new(envelope: &Envelope) -> Result<Self, FitError> {
        let scaling = Scaling::of(envelope)?;
        Ok(Self { scaling, times: scaling.unit_times(envelope), targets: scaling.scaled_logs(envelope) })
    }

    pub(crate) fn len(&self) -> usize {
        self.targets.len()
    }

    /// At most `most` of the peaks, evenly chosen, the first and the last among them.
    pub(crate) fn thinned(&self, most: usize) -> Self {
        if self.len() <= most {
            return self.clone();
        }
        let last = self.len() - 1;
        let chosen = |values: &[f64]| -> Vec<f64> {
            (0..most).filter_map(|at| values.get(at * last / (most - 1).max(1)).copied()).collect()
        };
        Self { times: chosen(&self.times), targets: chosen(&self.targets), ..self.clone() }
    }

    /// The mean square that rounding alone leaves of a perfect fit.
    pub(crate) fn rounding(&self) -> f64 {
        let digit = 16.0 * f64::EPSILON * (1.0 + (self.scaling.mean() / self.scaling.spread()).abs());
        digit * digit
    }

    /// Σ(x − x̄)².
    pub(crate) fn time_scatter(&self) -> f64 {
        let mean = self.times.iter().sum::<f64>() / self.len() as f64;
        self.times.iter().map(|time| (time - mean).powi(2)).sum()
    }

    /// The slope of the projection of a fitted function on a straight line over the peak times:
    /// Σ(x − x̄)f(x)/Σ(x − x̄)². It reads the expression, not the measured amplitudes.
    pub(crate) fn projected_slope(&self, fitted: &[f64]) -> f64 {
        let mean = self.times.iter().sum::<f64>() / self.len() as f64;
        // The mean goes out first: far fewer digits cancel.
        let level = fitted.iter().sum::<f64>() / self.len() as f64;
        let along: f64 =
            self.times.iter().zip(fitted).map(|(time, value)| (time - mean) * (value - level)).sum();
        along / self.time_scatter()
    }
}
