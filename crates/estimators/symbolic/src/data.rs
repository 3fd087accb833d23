//! The measured envelope in the coordinates that expressions work in.

use envelope::Envelope;
use estimator::FitError;

/// x = t/T in 0..1 with T the record's length, and z = (ln A − mean)/spread: a range, a mean and a standard
/// deviation, no line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Data {
    pub(crate) duration_s: f64,
    pub(crate) mean: f64,
    pub(crate) spread: f64,
    pub(crate) times: Vec<f64>,
    pub(crate) targets: Vec<f64>,
}

impl Data {
    pub(crate) fn new(envelope: &Envelope) -> Result<Self, FitError> {
        let duration_s = envelope.times_s().last().copied().unwrap_or_default();
        let logs = envelope.log_amplitudes();
        let count = logs.len() as f64;
        let mean = logs.iter().sum::<f64>() / count;
        let spread = (logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / count).sqrt();
        // Below this the logarithms differ by their rounding only.
        if !spread.is_finite() || spread <= 1e-13 * mean.abs().max(1.0) {
            return Err(FitError::NoSpread { spread });
        }
        Ok(Self {
            duration_s,
            mean,
            spread,
            times: envelope.times_s().iter().map(|time| time / duration_s).collect(),
            targets: logs.iter().map(|log| (log - mean) / spread).collect(),
        })
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

    /// ln A of a scaled value.
    pub(crate) fn log_amplitude(&self, scaled: f64) -> f64 {
        self.mean + self.spread * scaled
    }

    /// A rate in 1/s from one in scaled units.
    pub(crate) fn rate(&self, scaled: f64) -> f64 {
        scaled * self.spread / self.duration_s
    }

    /// The mean square that rounding alone leaves of a perfect fit.
    pub(crate) fn rounding(&self) -> f64 {
        let digit = 16.0 * f64::EPSILON * (1.0 + (self.mean / self.spread).abs());
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
