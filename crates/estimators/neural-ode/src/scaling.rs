//! The scaled coordinates the vector field works in.

use envelope::Envelope;
use estimator::FitError;

/// s = (t − middle)/half_range in −1..1 and z = (ln A − mean)/spread: no line is fitted here, only a
/// range, a mean and a standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scaling {
    middle: f64,
    half_range: f64,
    mean: f64,
    spread: f64,
}

impl Scaling {
    pub(crate) fn of(envelope: &Envelope) -> Result<Self, FitError> {
        let half_range = envelope.times_s().last().copied().unwrap_or_default() / 2.0;
        let logs = envelope.log_amplitudes();
        let count = logs.len() as f64;
        let mean = logs.iter().sum::<f64>() / count;
        let spread = (logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / count).sqrt();
        // Below this the logarithms differ by their rounding only.
        if !spread.is_finite() || spread <= 1e-13 * mean.abs().max(1.0) {
            return Err(FitError::NoSpread { spread });
        }
        // Peaks so close in time that a rate overflows tell of none.
        if !(spread / half_range).is_finite() {
            return Err(FitError::NoSpread { spread: spread / half_range });
        }
        Ok(Self { middle: half_range, half_range, mean, spread })
    }

    pub(crate) fn scaled_times(&self, envelope: &Envelope) -> Vec<f64> {
        envelope.times_s().iter().map(|time| (time - self.middle) / self.half_range).collect()
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
        scaled * self.spread / self.half_range
    }
}
