//! Least-squares line by linfa-linear: a check with independent code.

use crate::error::OracleError;
use envelope::Envelope;
use linfa::Dataset;
use linfa::traits::Fit;
use linfa_linear::LinearRegression;
use ndarray::{Array1, Array2};

/// Fits the decay rate in 1/s and ln A₀ by `linfa_linear::LinearRegression`, in plain double precision.
///
/// # Errors
/// [`OracleError::Library`] with the message of linfa.
pub fn linfa_decay_rate(envelope: &Envelope) -> Result<(f64, f64), OracleError> {
    let refused = |problem: String| OracleError::Library { problem };
    let times = Array2::from_shape_vec((envelope.len(), 1), envelope.times_s().to_vec())
        .map_err(|error| refused(error.to_string()))?;
    let targets = Array1::from_vec(envelope.log_amplitudes().to_vec());
    let model = LinearRegression::new()
        .fit(&Dataset::new(times, targets))
        .map_err(|error| refused(error.to_string()))?;
    let slope = model.params().first().copied().unwrap_or(f64::NAN);
    Ok((-slope, model.intercept()))
}

#[cfg(test)]
mod tests {
    use super::linfa_decay_rate;
    use crate::decay::decay_rate;
    use envelope::Envelope;

    #[test]
    fn linfa_agrees_with_the_certified_route() {
        let times: Vec<f64> = (0..69).map(|i| f64::from(i) * 0.288).collect();
        let logs: Vec<f64> =
            times.iter().map(|t| 0.5 - 0.19 * t + 0.1 * (3.0 * t).sin() - 0.003 * t * t).collect();
        let envelope = Envelope::new(times, logs, 21.8).unwrap();
        let (rate, log_amplitude) = linfa_decay_rate(&envelope).unwrap();
        let certified = decay_rate(&envelope).unwrap();
        assert!((rate / certified.decay_rate - 1.0).abs() < 1e-13);
        assert!((log_amplitude / certified.log_amplitude - 1.0).abs() < 1e-13);
    }
}
