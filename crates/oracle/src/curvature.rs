//! Curvature of ln A, as a test of whether ln A is a line.

use crate::certified::{Intercept, least_squares};
use crate::error::OracleError;
use envelope::Envelope;

/// Quadratic term of ln A = a − λ·t + q·t²: zero for viscous damping.
///
/// Dry friction bends ln A down (q < 0); drag that grows with speed bends it up (q > 0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curvature {
    /// Coefficient q, in 1/s².
    pub coefficient: f64,
    /// Standard error of q for independent residuals of one variance, in 1/s².
    pub std_error: f64,
    /// Coefficient of determination of the fit with the quadratic term.
    pub r_squared: f64,
}

/// Fits ln A by least squares on 1, t and t².
///
/// # Errors
/// [`OracleError`] if the envelope does not determine three coefficients to four digits.
pub fn curvature(envelope: &Envelope) -> Result<Curvature, OracleError> {
    let ones = vec![1.0; envelope.len()];
    let times = envelope.times_s();
    let squares: Vec<f64> = times.iter().map(|time| time * time).collect();
    let columns = [ones.as_slice(), times, squares.as_slice()];
    let fit = least_squares(&columns, envelope.log_amplitudes(), Intercept::Included)?;
    match (fit.coefficients.as_slice(), fit.std_errors.as_slice()) {
        (&[_, _, coefficient], &[_, _, std_error]) => {
            Ok(Curvature { coefficient, std_error, r_squared: fit.r_squared })
        }
        _ => Err(OracleError::TooFewRows { rows: envelope.len(), columns: 3 }),
    }
}

#[cfg(test)]
mod tests {
    use super::curvature;
    use envelope::Envelope;

    #[test]
    fn a_bend_is_found_with_its_sign() {
        let times: Vec<f64> = (0..40).map(|i| 0.3 * f64::from(i)).collect();
        let logs = times.iter().map(|t| 1.0 - 0.2 * t - 0.003 * t * t).collect();
        let found = curvature(&Envelope::new(times, logs, 21.0).unwrap()).unwrap();
        assert!((found.coefficient / -0.003 - 1.0).abs() < 1e-10, "{found:?}");
        assert!(found.std_error < 1e-14);
    }
}
