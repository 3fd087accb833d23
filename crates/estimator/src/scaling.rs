//! Scaled coordinates that estimators work in.

use crate::error::FitError;
use envelope::Envelope;

/// Scaling of time by the envelope's length, and of ln A by its mean and spread. No line is fitted here: the
/// scaling takes a range, a mean and a standard deviation from the data.
///
/// Two scaled times are in use: τ = t/duration in 0..1 ([`Scaling::unit_time`]) and s = 2·t/duration − 1 in
/// −1..1 ([`Scaling::centered_time`]). The scaled logarithm is z = (ln A − mean)/spread, with mean 0 and
/// standard deviation 1 over the peaks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scaling {
    duration: f64,
    mean: f64,
    spread: f64,
}

impl Scaling {
    /// Returns the scaling of an envelope.
    ///
    /// # Errors
    /// [`FitError::NoSpread`] if the logarithms differ only by rounding, or if the peaks lie so close in time
    /// that a rate overflows a double.
    pub fn of(envelope: &Envelope) -> Result<Self, FitError> {
        let duration = envelope.duration_s();
        let logs = envelope.log_amplitudes();
        let count = logs.len() as f64;
        let mean = logs.iter().sum::<f64>() / count;
        let spread = (logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / count).sqrt();
        // A rate in scaled units may be a thousand times the spread over the duration.
        let usable = spread > 1e-13 * mean.abs().max(1.0) && (1e3 * spread / duration).is_finite();
        if usable { Ok(Self { duration, mean, spread }) } else { Err(FitError::NoSpread { spread }) }
    }

    /// Returns the time from the first peak to the last, in seconds.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Returns the mean of ln A over the peaks.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Returns the standard deviation of ln A over the peaks, with their number as divisor.
    #[must_use]
    pub fn spread(&self) -> f64 {
        self.spread
    }

    /// Returns τ of a time in seconds: 0 at the first peak, 1 at the last.
    #[must_use]
    pub fn unit_time(&self, time_s: f64) -> f64 {
        time_s / self.duration
    }

    /// Returns s of a time in seconds: −1 at the first peak, 1 at the last.
    #[must_use]
    pub fn centered_time(&self, time_s: f64) -> f64 {
        2.0 * self.unit_time(time_s) - 1.0
    }

    /// Returns z of ln A.
    #[must_use]
    pub fn scaled_log(&self, log_amplitude: f64) -> f64 {
        (log_amplitude - self.mean) / self.spread
    }

    /// Returns τ of every peak.
    #[must_use]
    pub fn unit_times(&self, envelope: &Envelope) -> Vec<f64> {
        envelope.times_s().iter().map(|&time| self.unit_time(time)).collect()
    }

    /// Returns s of every peak.
    #[must_use]
    pub fn centered_times(&self, envelope: &Envelope) -> Vec<f64> {
        envelope.times_s().iter().map(|&time| self.centered_time(time)).collect()
    }

    /// Returns z of every peak.
    #[must_use]
    pub fn scaled_logs(&self, envelope: &Envelope) -> Vec<f64> {
        envelope.log_amplitudes().iter().map(|&log| self.scaled_log(log)).collect()
    }

    /// Returns ln A of a scaled logarithm z.
    #[must_use]
    pub fn log_amplitude(&self, scaled: f64) -> f64 {
        self.mean + self.spread * scaled
    }

    /// Converts a difference or a standard deviation of z to one of ln A.
    #[must_use]
    pub fn deviation(&self, scaled: f64) -> f64 {
        scaled * self.spread
    }

    /// Converts a rate per unit of τ to 1/s.
    #[must_use]
    pub fn rate_per_unit_time(&self, scaled: f64) -> f64 {
        scaled * (self.spread / self.duration)
    }

    /// Converts a rate per unit of s to 1/s; s covers twice the range of τ.
    #[must_use]
    pub fn rate_per_centered_time(&self, scaled: f64) -> f64 {
        scaled * (2.0 * self.spread / self.duration)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::Scaling;
    use crate::FitError;
    use envelope::Envelope;

    #[test]
    fn scaled_and_back() {
        let envelope = Envelope::new(vec![1.0, 2.0, 5.0], vec![3.0, 1.0, -1.0], 6.0).unwrap();
        let scaling = Scaling::of(&envelope).unwrap();
        assert_eq!(scaling.unit_times(&envelope), [0.0, 0.25, 1.0]);
        assert_eq!(scaling.centered_times(&envelope), [-1.0, -0.5, 1.0]);
        let logs = scaling.scaled_logs(&envelope);
        assert!(logs.iter().sum::<f64>().abs() < 1e-15);
        assert!((logs.iter().map(|z| z * z).sum::<f64>() / 3.0 - 1.0).abs() < 1e-15);
        assert!(
            logs.iter()
                .zip(envelope.log_amplitudes())
                .all(|(&z, log)| { (scaling.log_amplitude(z) - log).abs() < 1e-15 })
        );
        // ln A = −t/2 has the same rate in both scaled times.
        let slope = scaling.scaled_log(-2.0) - scaling.scaled_log(0.0);
        assert!((scaling.rate_per_unit_time(slope) + 0.5).abs() < 1e-15);
        assert!((scaling.rate_per_centered_time(slope / 2.0) + 0.5).abs() < 1e-15);
        assert!((scaling.deviation(slope) + 2.0).abs() < 1e-15);
    }

    #[test]
    fn envelopes_without_a_spread_are_refused() {
        for (times, logs) in [
            (vec![0.0, 1.0, 2.0], vec![0.3; 3]),
            (vec![0.0, 1.0, 2.0], vec![1e200, 2e200, 0.0]),
            (vec![0.0, 1e-310, 2e-310], vec![2.0, 1.0, 0.0]),
        ] {
            let envelope = Envelope::new(times, logs, 6.0).unwrap();
            assert!(matches!(Scaling::of(&envelope), Err(FitError::NoSpread { .. })));
        }
    }
}
