//! Agreement of independent estimates of one quantity.

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Comparison of estimates of one quantity with their weighted mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// Mean, weighted by the inverse squared standard errors.
    pub mean: f64,
    /// Standard error of the mean, if all estimates are of one quantity.
    pub std_error: f64,
    /// Cochran's Q: squared distances from the mean over squared standard errors, summed.
    pub chi_squared: f64,
    /// Degrees of freedom of Q: one less than the number of estimates.
    pub degrees: usize,
    /// Probability of a Q at least this large if the estimates are of one quantity and their errors are
    /// normal.
    pub p_value: f64,
    /// Indices of the two estimates that are farthest apart in standard errors of their difference, and that
    /// distance.
    pub farthest: (usize, usize, f64),
}

/// Compares estimates of one quantity, each a value with its standard error. `None` for fewer than two
/// estimates, or if a value is not finite or a standard error is not finite and above zero.
///
/// Source: W. G. Cochran, The combination of estimates from different experiments, Biometrics 10 (1954).
#[must_use]
pub fn agreement(estimates: &[(f64, f64)]) -> Option<Agreement> {
    let is_usable = |(value, error): &(f64, f64)| value.is_finite() && error.is_finite() && *error > 0.0;
    if estimates.len() < 2 || !estimates.iter().all(is_usable) {
        return None;
    }
    let weights: f64 = estimates.iter().map(|(_, error)| error.powi(-2)).sum();
    let mean = estimates.iter().map(|(value, error)| value * error.powi(-2)).sum::<f64>() / weights;
    let chi_squared = estimates.iter().map(|(value, error)| ((value - mean) / error).powi(2)).sum();
    let degrees = estimates.len() - 1;
    let p_value = ChiSquared::new(degrees as f64).ok()?.sf(chi_squared);
    let mut farthest = (0, 1, 0.0);
    for (at, (one, one_error)) in estimates.iter().enumerate() {
        for (other_at, (other, other_error)) in estimates.iter().enumerate().skip(at + 1) {
            let distance = (one - other).abs() / one_error.hypot(*other_error);
            if distance > farthest.2 {
                farthest = (at, other_at, distance);
            }
        }
    }
    Some(Agreement { mean, std_error: weights.powf(-0.5), chi_squared, degrees, p_value, farthest })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::agreement;

    #[test]
    fn equal_estimates_agree_and_share_their_mean() {
        let found = agreement(&[(2.0, 0.1), (2.0, 0.1), (2.0, 0.05)]).unwrap();
        assert_eq!((found.mean, found.chi_squared, found.degrees), (2.0, 0.0, 2));
        assert!((found.p_value - 1.0).abs() < 1e-12);
        // 1/√(100 + 100 + 400).
        assert!((found.std_error - 600f64.powf(-0.5)).abs() < 1e-15);
    }

    /// Two estimates with errors of 3 and 4 have a difference with an error of 5; for two estimates, Q is one
    /// squared distance.
    #[test]
    fn the_two_that_are_farthest_apart_are_told() {
        let found = agreement(&[(0.0, 3.0), (1.0, 3.0), (25.0, 4.0)]).unwrap();
        assert_eq!((found.farthest.0, found.farthest.1), (0, 2));
        assert!((found.farthest.2 - 5.0).abs() < 1e-12, "{found:?}");
        let pair = agreement(&[(0.0, 3.0), (25.0, 4.0)]).unwrap();
        assert!((pair.chi_squared - 25.0).abs() < 1e-9 && pair.p_value < 1e-5, "{pair:?}");
    }

    #[test]
    fn what_cannot_be_compared_has_no_agreement() {
        assert!(agreement(&[(1.0, 0.1)]).is_none());
        assert!(agreement(&[(1.0, 0.1), (1.0, 0.0)]).is_none());
        assert!(agreement(&[(1.0, 0.1), (f64::NAN, 0.1)]).is_none());
    }
}
