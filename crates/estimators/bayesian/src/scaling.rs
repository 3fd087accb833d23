//! The scaled coordinates the regression works in.

use envelope::Envelope;
use estimator::FitError;

/// τ = t/duration in 0..1 and z = (ln A − mean)/spread: no line is fitted here, only a range, a mean and a
/// standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scaling {
    duration: f64,
    mean: f64,
    spread: f64,
}

impl Scaling {
    pub(crate) fn of(envelope: &Envelope) -> Result<Self, FitError> {
        let duration = envelope.times_s().last().copied().unwrap_or_default();
        let logs = envelope.log_amplitudes();
        let count = logs.len() as f64;
        let mean = logs.iter().sum::<f64>() / count;
        let spread = (logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / count).sqrt();
        // Below this the logarithms differ by their rounding only; beyond the range of a double there is
        // no unit to give a rate in.
        let usable = spread > 1e-13 * mean.abs().max(1.0) && (1e3 * spread / duration).is_finite();
        if !usable {
            return Err(FitError::NoSpread { spread });
        }
        Ok(Self { duration, mean, spread })
    }

    pub(crate) fn scaled_times(&self, envelope: &Envelope) -> Vec<f64> {
        envelope.times_s().iter().map(|time| time / self.duration).collect()
    }

    pub(crate) fn scaled_logs(&self, envelope: &Envelope) -> Vec<f64> {
        envelope.log_amplitudes().iter().map(|log| (log - self.mean) / self.spread).collect()
    }

    /// ln A of a scaled value.
    pub(crate) fn log_amplitude(&self, scaled: f64) -> f64 {
        self.mean + self.spread * scaled
    }

    /// A rate in 1/s from one in scaled units.
    pub(crate) fn rate(&self, scaled: f64) -> f64 {
        scaled * (self.spread / self.duration)
    }

    /// A standard deviation of ln A from one in scaled units.
    pub(crate) fn scatter(&self, scaled: f64) -> f64 {
        scaled * self.spread
    }
}
