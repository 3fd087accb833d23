//! Decay rate of an envelope.

use crate::certified::{Intercept, least_squares};
use crate::error::OracleError;
use envelope::Envelope;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Least-squares fit of ln A = ln A₀ − λ·t.
#[derive(Debug, Clone, PartialEq)]
pub struct DecayFit {
    /// Decay rate λ, in 1/s.
    pub decay_rate: f64,
    /// ln A₀ at the first peak, with the amplitude in the record's unit.
    pub log_amplitude: f64,
    /// Damping ratio ζ by the envelope's definition, [`Envelope::damping_ratio`].
    pub zeta: f64,
    /// Standard error of λ for independent residuals, in 1/s. Their variance is constant, or proportional to
    /// the variances that the envelope states ([`Envelope::log_std_errors`]) and at least as large.
    pub std_error: f64,
    /// Ratio of `std_error` to the standard error under constant variance; 1 if the envelope states no
    /// variances.
    pub scatter_factor: f64,
    /// 95 % interval of λ by Student's t with n − 2 degrees of freedom, in 1/s.
    pub interval_95: [f64; 2],
    /// Standard error of ζ, with the frequency taken as exact.
    pub zeta_std_error: f64,
    /// Coefficient of determination.
    pub r_squared: f64,
    /// Two-norm condition number of the column-scaled design matrix.
    pub condition: f64,
    /// Significant digits promised for λ and ln A₀.
    pub promised_digits: f64,
    /// Lag-one autocorrelation of the residuals. Near 0 the standard errors are credible; near 1 the envelope
    /// is not an exponential, and they are too small.
    pub residual_autocorrelation: f64,
}

impl DecayFit {
    /// Returns the line ln A₀ − λ·t at a time in seconds after the first peak, with the amplitude in the
    /// record's unit.
    #[must_use]
    pub fn log_amplitude_at(&self, time_s: f64) -> f64 {
        self.log_amplitude - self.decay_rate * time_s
    }
}

/// Computes the decay rate of an envelope by closed-form least squares.
///
/// # Errors
/// [`OracleError`] if the envelope does not determine a line to four digits.
pub fn decay_rate(envelope: &Envelope) -> Result<DecayFit, OracleError> {
    let ones = vec![1.0; envelope.len()];
    let columns = [ones.as_slice(), envelope.times_s()];
    let fit = least_squares(&columns, envelope.log_amplitudes(), Intercept::Included)?;
    let (&[log_amplitude, slope], &[_, std_error]) = (fit.coefficients.as_slice(), fit.std_errors.as_slice())
    else {
        return Err(OracleError::TooFewRows { rows: envelope.len(), columns: 2 });
    };
    let degrees = (envelope.len() - 2) as f64;
    let quantile = StudentsT::new(0.0, 1.0, degrees).map_or(f64::NAN, |t| t.inverse_cdf(0.975));
    let decay_rate = -slope;
    let scatter_factor = match uneven_std_error(envelope, &fit.residuals) {
        Some(uneven) if std_error > 0.0 => uneven / std_error,
        _ => 1.0,
    };
    let std_error = scatter_factor * std_error;
    Ok(DecayFit {
        decay_rate,
        log_amplitude,
        zeta: envelope.damping_ratio(decay_rate),
        std_error,
        scatter_factor,
        interval_95: [decay_rate - quantile * std_error, decay_rate + quantile * std_error],
        zeta_std_error: envelope.damping_ratio_error(decay_rate, std_error),
        r_squared: fit.r_squared,
        condition: fit.condition,
        promised_digits: fit.promised_digits,
        residual_autocorrelation: autocorrelation(&fit.residuals),
    })
}

/// Returns the standard error of the unweighted least-squares slope if the scatter of ln A grows as the swing
/// decays.
///
/// The variances that the envelope states are raised by the common factor RSS/E\[RSS\] if the residuals are
/// larger than expected (Birge 1932); they are never lowered. `None` if the envelope states none.
fn uneven_std_error(envelope: &Envelope, residuals: &[f64]) -> Option<f64> {
    let variances = || envelope.log_std_errors().into_iter().flatten().map(|error| error * error);
    envelope.log_std_errors()?;
    let times = envelope.times_s();
    let count = times.len() as f64;
    let mean = times.iter().sum::<f64>() / count;
    let spread: f64 = times.iter().map(|time| (time - mean).powi(2)).sum();
    let leverage = |time: &f64| 1.0 / count + (time - mean).powi(2) / spread;
    let expected: f64 =
        variances().zip(times).map(|(variance, time)| variance * (1.0 - leverage(time))).sum();
    let found: f64 = residuals.iter().map(|residual| residual * residual).sum();
    let slope: f64 =
        variances().zip(times).map(|(variance, time)| variance * ((time - mean) / spread).powi(2)).sum();
    let error = ((found / expected).max(1.0) * slope).sqrt();
    error.is_finite().then_some(error)
}

/// Returns the lag-one autocorrelation of residuals with mean 0; 0 if all residuals are 0.
fn autocorrelation(residuals: &[f64]) -> f64 {
    let square: f64 = residuals.iter().map(|r| r * r).sum();
    let product: f64 = residuals.iter().zip(residuals.iter().skip(1)).map(|(a, b)| a * b).sum();
    if square > 0.0 { product / square } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::{autocorrelation, decay_rate};
    use envelope::Envelope;

    #[test]
    fn three_peaks_by_hand() {
        // Slope 3/2, residuals 1/2, −1, 1/2: s² = 3/2, Sxx = 2, R² = 1 − (3/2)/6.
        let envelope = Envelope::new(vec![0.0, 1.0, 2.0], vec![1.0, 1.0, 4.0], 6.0).unwrap();
        let fit = decay_rate(&envelope).unwrap();
        let error = 0.75_f64.sqrt();
        // Student's t with one degree of freedom is Cauchy's distribution: tan(0.475·π).
        let quantile = (0.475 * std::f64::consts::PI).tan();
        for (found, expected) in [
            (fit.decay_rate, -1.5),
            (fit.log_amplitude, 0.5),
            (fit.zeta, -0.25),
            (fit.std_error, error),
            (fit.zeta_std_error, error / 6.0),
            (fit.r_squared, 0.75),
            (fit.residual_autocorrelation, -2.0 / 3.0),
            (fit.log_amplitude_at(4.0), 6.5),
            (fit.interval_95[0], -1.5 - quantile * error),
            (fit.interval_95[1], -1.5 + quantile * error),
        ] {
            assert!((found - expected).abs() < 1e-9 * expected.abs(), "{found} {expected} {fit:?}");
        }
    }

    /// The quantile of t with n − 2 degrees of freedom is 2.306 for eight.
    #[test]
    fn ten_peaks_leave_eight_degrees_of_freedom() {
        let times: Vec<f64> = (0..10).map(f64::from).collect();
        let logs = times.iter().map(|t| (7.0 * t).sin()).collect();
        let fit = decay_rate(&Envelope::new(times, logs, 6.0).unwrap()).unwrap();
        let half_width = (fit.interval_95[1] - fit.interval_95[0]) / 2.0;
        assert!((half_width / fit.std_error - 2.306_004).abs() < 1e-5);
    }

    /// With times −1, 0, 1 about their mean, the slope is half the difference of the ends.
    #[test]
    fn scatter_that_grows_widens_the_error_and_quiet_residuals_do_not_narrow_it() {
        let envelope = Envelope::new(vec![0.0, 1.0, 2.0], vec![1.0, 1.0, 4.0], 6.0).unwrap();
        let error =
            |logs: Vec<f64>| decay_rate(&envelope.clone().with_log_std_errors(logs)).unwrap().std_error;
        // RSS = 3/2, and E[RSS] = 100/6 + 4/6 + 900/6.
        assert!((error(vec![10.0, 1.0, 30.0]) - 250_f64.sqrt()).abs() < 1e-9);
        // With a tenth of each error, RSS is more than E[RSS].
        let factor: f64 = 1.5 / (0.01 / 6.0 + 0.000_4 / 6.0 + 0.09 / 6.0);
        assert!((error(vec![0.1, 0.01, 0.3]) - (factor * 0.025).sqrt()).abs() < 1e-9);
        assert_eq!(decay_rate(&envelope).unwrap().scatter_factor, 1.0);
    }

    #[test]
    fn neighbors_that_agree_oppose_or_are_not() {
        assert_eq!(autocorrelation(&[]), 0.0);
        assert_eq!(autocorrelation(&[0.0, 0.0]), 0.0);
        assert_eq!(autocorrelation(&[1.0, -1.0, 1.0, -1.0]), -0.75);
        assert_eq!(autocorrelation(&[1.0, 1.0, -1.0, -1.0]), 0.25);
    }
}
