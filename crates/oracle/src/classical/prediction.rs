//! Predictions of a line for peaks that were not fitted.

use super::ClassicalFit;
use super::vectors::{dot, length, sum};
use envelope::Envelope;

/// ln A of a line at a time, with the scatter of a measured peak about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinePrediction {
    /// Value of ln A₀ − λ·t, with the amplitude in the record's unit.
    pub log_amplitude: f64,
    /// Standard deviation of a **measured** ln A about the line, from scatter and the line's own uncertainty
    /// together; `None` if two peaks or fewer leave no degree of freedom, or if it is not finite.
    pub std_error: Option<f64>,
}

impl ClassicalFit {
    /// Predicts by the line at times in seconds after the first peak, within the envelope or beyond it, one
    /// prediction per time.
    ///
    /// With n peaks, their mean time t̄ and Sxx = Σ(tᵢ − t̄)², a measured ln A has the variance
    /// s²·(1 + 1/n + (t − t̄)²/Sxx) if the scatter is independent and of one variance. Here s² = Σrᵢ²/(n − 2)
    /// from this method's own residuals r. `envelope` is the one that was fitted.
    ///
    /// # Reference
    /// Draper, Smith, Applied Regression Analysis (3rd ed., Wiley 1998), section 3.1.
    #[must_use]
    pub fn predictions(&self, envelope: &Envelope, times_s: &[f64]) -> Vec<LinePrediction> {
        let at = |time: f64| (-self.decay_rate).mul_add(time, self.log_amplitude);
        let (times, logs) = (envelope.times_s(), envelope.log_amplitudes());
        let count = times.len() as f64;
        let residuals: Vec<f64> = times.iter().zip(logs).map(|(&time, log)| log - at(time)).collect();
        let mean = sum(times) / count;
        let centered: Vec<f64> = times.iter().map(|time| time - mean).collect();
        let scatter = (dot(&residuals, &residuals) / (count - 2.0)).sqrt();
        // Lengths before squares: the squares of times of 1e-200 s underflow.
        let spread = length(&centered);
        let std_error = |time: f64| {
            let leverage = 1.0 / count + ((time - mean) / spread).powi(2);
            let error = scatter * (1.0 + leverage).sqrt();
            (count > 2.0 && error.is_finite()).then_some(error)
        };
        let predict = |&time: &f64| LinePrediction { log_amplitude: at(time), std_error: std_error(time) };
        times_s.iter().map(predict).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::classical::{CLASSICAL, ClassicalFit};
    use envelope::Envelope;
    use rand::RngExt;
    use seed::Seed;

    fn fitted(id: &str, envelope: &Envelope) -> ClassicalFit {
        let route = CLASSICAL.iter().find(|route| route.id == id).unwrap();
        (route.fit)(envelope, &Seed::new(0)).unwrap()
    }

    #[test]
    fn three_peaks_by_hand() {
        // ln A = 1/2 − (−3/2)·t, residuals 1/2, −1, 1/2: s² = 3/2; t̄ = 1, Sxx = 2.
        let envelope = Envelope::new(vec![0.0, 1.0, 2.0], vec![1.0, 1.0, 4.0], 6.0).unwrap();
        let found = fitted("ols", &envelope).predictions(&envelope, &[1.0, 3.0]);
        for (prediction, (log, variance)) in found.iter().zip([(2.0, 2.0), (5.0, 5.0)]) {
            assert!((prediction.log_amplitude - log).abs() < 1e-14, "{prediction:?}");
            assert!((prediction.std_error.unwrap() - f64::sqrt(variance)).abs() < 1e-14, "{prediction:?}");
        }
    }

    #[test]
    fn all_eleven_predict_and_agree() {
        let times: Vec<f64> = (0..69).map(|i| f64::from(i) * 0.288).collect();
        let logs = times.iter().map(|t| -0.6 - 0.19 * t + 0.1 * (7.0 * t).sin()).collect();
        let envelope = Envelope::new(times, logs, 21.8).unwrap();
        let asked = [-1.0, 0.0, 7.3, 19.5, 60.0];
        let first = fitted("ols", &envelope).predictions(&envelope, &asked);
        for route in CLASSICAL {
            let found = fitted(route.id, &envelope).predictions(&envelope, &asked);
            for (found, first) in found.iter().zip(&first) {
                assert!((found.log_amplitude - first.log_amplitude).abs() < 1e-6, "{}", route.id);
                let ratio = found.std_error.unwrap() / first.std_error.unwrap();
                assert!((ratio - 1.0).abs() < 1e-9, "{}", route.id);
            }
        }
    }

    #[test]
    fn intervals_hold_fresh_peaks_as_often_as_they_say() {
        let mut generator = Seed::new(8).generator();
        // A sum of twelve uniform numbers is close enough to a Gaussian.
        let mut scatter = || 0.1 * ((0..12).map(|_| generator.random::<f64>()).sum::<f64>() - 6.0);
        let truth = |time: f64| -0.6 - 0.19 * time;
        let trials: u32 = 4000;
        let held = (0..trials)
            .filter(|trial| {
                let times: Vec<f64> = (0..60).map(|i| 0.3 * f64::from(i)).collect();
                let logs = times.iter().map(|&time| truth(time) + scatter()).collect();
                let envelope = Envelope::new(times, logs, 21.8).unwrap();
                // Times from within the record to one record length beyond its end.
                let asked = 36.0 * f64::from(*trial) / f64::from(trials);
                let prediction = fitted("ols", &envelope).predictions(&envelope, &[asked])[0];
                let off = truth(asked) + scatter() - prediction.log_amplitude;
                // Quantile of Student's t with 58 degrees of freedom.
                off.abs() <= 2.0017 * prediction.std_error.unwrap()
            })
            .count();
        let share = held as f64 / f64::from(trials);
        // The bounds are four standard deviations of a share of 4000.
        assert!((share - 0.95).abs() < 4.0 * (0.95 * 0.05 / f64::from(trials)).sqrt(), "{share}");
    }

    #[test]
    fn times_too_short_to_square_have_errors_all_the_same() {
        let envelope = Envelope::new(vec![0.0, 1e-200, 2e-200], vec![0.0, 1.0, 0.0], 1.0).unwrap();
        let fit = ClassicalFit { decay_rate: 0.0, log_amplitude: 1.0 / 3.0, ..fitted_at_one_second() };
        let error = fit.predictions(&envelope, &[1e-200])[0].std_error.unwrap();
        assert!((error - (2.0_f64 / 3.0 * 4.0 / 3.0).sqrt()).abs() < 1e-14, "{error}");
    }

    fn fitted_at_one_second() -> ClassicalFit {
        fitted("ols", &Envelope::new(vec![0.0, 1.0, 2.0], vec![0.0, 1.0, 0.0], 1.0).unwrap())
    }
}
