//! Measured envelope in the coordinates of the expressions.

use envelope::Envelope;
use estimator::{FitError, Scaling};

/// Peaks in scaled units: τ in 0..1 and z.
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

    /// Returns at most `most` of the peaks, evenly chosen, including the first and the last.
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

    /// Returns the mean square error of a perfect fit due to rounding.
    pub(crate) fn rounding(&self) -> f64 {
        let digit = 16.0 * f64::EPSILON * (1.0 + (self.scaling.mean() / self.scaling.spread()).abs());
        digit * digit
    }

    /// Returns Σ(x − x̄)².
    pub(crate) fn time_scatter(&self) -> f64 {
        let mean = self.times.iter().sum::<f64>() / self.len() as f64;
        self.times.iter().map(|time| (time - mean).powi(2)).sum()
    }

    /// Returns the slope of the projection of a fitted function on a straight line over the peak times: Σ(x −
    /// x̄)f(x)/Σ(x − x̄)². It uses the expression and not the measured amplitudes.
    pub(crate) fn projected_slope(&self, fitted: &[f64]) -> f64 {
        let mean = self.times.iter().sum::<f64>() / self.len() as f64;
        // The mean is subtracted first, so that far fewer digits cancel.
        let level = fitted.iter().sum::<f64>() / self.len() as f64;
        let along: f64 =
            self.times.iter().zip(fitted).map(|(time, value)| (time - mean) * (value - level)).sum();
        along / self.time_scatter()
    }
}
