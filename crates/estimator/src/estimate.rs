//! Estimate of an estimator, with its uncertainty, its predictions and its trained model.

use results::Reached;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// State in which a fit ended, and the reason.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stop {
    /// State in which it ended.
    pub reached: Reached,
    /// A sentence with numbers; it also says what to do if the fit did not converge.
    pub because: String,
}

/// Uncertainty of a decay rate, as stated by the method itself.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Uncertainty {
    /// Standard error of λ, in 1/s.
    pub std_error: f64,
    /// 95 % interval of λ, in 1/s.
    pub interval_95: [f64; 2],
}

impl Uncertainty {
    /// Returns the symmetric interval of Student's t distribution.
    ///
    /// `decay_rate` and `std_error` are in 1/s; `degrees_of_freedom` is above 0. `None` if a number is not
    /// finite, `std_error` is negative or `degrees_of_freedom` is not positive.
    #[must_use]
    pub fn students_t(decay_rate: f64, std_error: f64, degrees_of_freedom: f64) -> Option<Self> {
        let usable = decay_rate.is_finite() && std_error.is_finite() && std_error >= 0.0;
        let quantile =
            StudentsT::new(0.0, 1.0, degrees_of_freedom).ok().filter(|_| usable)?.inverse_cdf(0.975);
        let half_width = quantile * std_error;
        Some(Self { std_error, interval_95: [decay_rate - half_width, decay_rate + half_width] })
    }
}

/// Prediction of ln A at one time, for a peak that the fit may not have seen. Only [`Prediction::new`] makes
/// one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Prediction {
    /// ln A at the query time, with the amplitude in the record's unit: the value of the fitted function.
    ///
    /// Beyond the peaks not every function has a finite value: −∞ if the motion has come to rest by then (dry
    /// friction ends it), +∞ if it has grown without bound, NaN if the function is not defined there (the
    /// logarithm of an expression that has turned negative) or if the method cannot follow it that far. Check
    /// [`is_finite`](f64::is_finite) before computing with it.
    pub log_amplitude: f64,
    /// Standard deviation of a **measured** ln A about the prediction, from scatter and the fit's own
    /// uncertainty together: finite and at least 0. `None` if the method states none or `log_amplitude` is
    /// not finite.
    pub std_error: Option<f64>,
}

impl Prediction {
    /// Creates a prediction. The standard deviation is dropped if it or `log_amplitude` is not finite.
    #[must_use]
    pub fn new(log_amplitude: f64, std_error: Option<f64>) -> Self {
        let usable = |std_error: &f64| log_amplitude.is_finite() && std_error.is_finite();
        Self { log_amplitude, std_error: std_error.filter(usable) }
    }
}

/// A trained model as a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModelFile {
    /// Name of the file, such as `weights.safetensors`.
    pub name: String,
    /// Content of the file.
    pub bytes: Vec<u8>,
}

/// Result of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Decay rate λ, in 1/s: finite, of either sign (an envelope may grow).
    pub decay_rate: f64,
    /// ln A at the first peak, with the amplitude in the record's unit: finite.
    pub log_amplitude: f64,
    /// Uncertainty of λ; `None` if the method states none.
    pub uncertainty: Option<Uncertainty>,
    /// State in which the fit ended, and the reason.
    pub stop: Stop,
    /// Number of training steps taken.
    pub steps: u64,
    /// Number of trained parameters.
    pub parameters: usize,
    /// Values of the fitted function ln A at the envelope's times.
    pub fitted_log_amplitudes: Vec<f64>,
    /// Values of the fitted function at [`FitContext::query_times`](crate::FitContext::query_times), one per
    /// time, in their order.
    pub predictions: Vec<Prediction>,
    /// Law that the method discovered, in the record's units; `None` if the method discovers no laws.
    pub equation: Option<String>,
    /// Trained model; `None` if there is nothing to save.
    pub model: Option<ModelFile>,
}

impl Estimate {
    /// Returns the earliest query time without a finite prediction; `None` if all have one.
    ///
    /// `query_times` are those of the fit.
    #[must_use]
    pub fn first_without_prediction(&self, query_times: &[f64]) -> Option<f64> {
        let finite = self.predictions.iter().map(|prediction| prediction.log_amplitude.is_finite());
        let missing = query_times.iter().zip(finite.chain(std::iter::repeat(false)));
        missing.filter(|(_, finite)| !finite).map(|(time, _)| *time).min_by(f64::total_cmp)
    }
}

#[cfg(test)]
mod tests {
    use super::{Estimate, Prediction, Reached, Stop};

    #[test]
    fn an_error_of_what_is_not_finite_is_none() {
        let error =
            |log_amplitude: f64, std_error: f64| Prediction::new(log_amplitude, Some(std_error)).std_error;
        assert_eq!(error(-1.0, 0.1), Some(0.1));
        assert_eq!([error(-1.0, f64::INFINITY), error(-1.0, f64::NAN)], [None; 2]);
        assert_eq!([error(f64::NEG_INFINITY, 0.1), error(f64::NAN, 0.1)], [None; 2]);
    }

    #[test]
    fn the_first_time_without_a_prediction_is_found_in_any_order() {
        let estimate = |logs: &[f64]| Estimate {
            decay_rate: 0.1,
            log_amplitude: 0.0,
            uncertainty: None,
            stop: Stop { reached: Reached::Converged, because: String::new() },
            steps: 0,
            parameters: 1,
            fitted_log_amplitudes: Vec::new(),
            predictions: logs.iter().map(|&log| Prediction::new(log, None)).collect(),
            equation: None,
            model: None,
        };
        let times = [9.0, 1.0, 7.0, 8.0];
        let found = |logs: &[f64]| estimate(logs).first_without_prediction(&times);
        assert_eq!(found(&[-3.0, -1.0, -2.0, -2.5]), None);
        assert_eq!(found(&[f64::NEG_INFINITY, -1.0, -2.0, f64::NAN]), Some(8.0));
        assert_eq!(found(&[]), Some(1.0));
    }
}
