//! Tests of whole fits: those shared by all methods that discover laws, and those of this method.

#[path = "../../../sparse/testing/laws.rs"]
mod laws;

use estimator::{Cancel, FitContext, Reached, Silent};
use laws::{damped, estimator, line};
use seed::Seed;

/// The remaining difference is the error of the quadrature between the peaks.
const AGREEMENT: f64 = 1e-7;

/// Another law may be chosen here, with its own quadrature error.
const ADDED: f64 = 1e-5;

/// Test functions cannot separate peaks that are crowded into 1e-9 of the record, and the quadrature is
/// coarse where the motion of a law ends.
fn odd_bar(at: usize, rate: f64) -> f64 {
    let bar = [9, 10].iter().position(|odd| *odd == at).map_or(1e-5, |odd| [0.1, 0.01][odd]);
    bar * rate.abs().max(1e-9)
}

#[test]
fn terms_at_the_peaks_leave_a_bias_that_terms_along_the_trajectory_do_not() {
    let rates = |along: &str| {
        let estimator = estimator(&[along]);
        let cancel = Cancel::new();
        let context = FitContext::new(Seed::new(0), None, &Silent, &cancel);
        (0..10)
            .map(|seed| {
                let envelope = damped(69, 20.0, [0.13, 0.0035, 0.0], 0.1, seed);
                let estimate = estimator.fit(&envelope, &context).unwrap();
                assert_eq!(estimate.stop.reached, Reached::Converged);
                (estimate.decay_rate / line(&envelope).0 - 1.0).abs()
            })
            .fold(0.0, f64::max)
    };
    let (peaks, trajectory) =
        (rates("estimator.terms_along=peaks"), rates("estimator.terms_along=trajectory"));
    assert!(peaks < 0.02 && trajectory < 1e-6 && trajectory < peaks, "{peaks:e} {trajectory:e}");
}

#[test]
fn fewer_test_functions_know_less_and_say_so() {
    let envelope = damped(69, 20.0, [0.2, 0.0, 0.0], 0.1, 3);
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(0), None, &Silent, &cancel);
    let errors = [3, 30, 200].map(|most| {
        let estimator = estimator(&[&format!("estimator.test_functions={most}")]);
        let estimate = estimator.fit(&envelope, &context).unwrap();
        let (rate, std_error) = line(&envelope);
        let known = estimate.uncertainty.unwrap().std_error;
        assert!(
            (estimate.decay_rate - rate).abs() < (known * known - 0.999 * std_error * std_error).sqrt() * 3.0
        );
        known
    });
    assert!(errors[0] > errors[1] && errors[1] > errors[2], "{errors:?}");
}
