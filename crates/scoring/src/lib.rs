//! How far an estimate is from the oracle, and whether that passes.

/// Relative distance of an estimate from the oracle, in percent: |x − x₀| / |x₀| · 100.
///
/// Infinite where the oracle is zero and the estimate is not; 0 where both are.
#[must_use]
pub fn error_percent(estimate: f64, oracle: f64) -> f64 {
    let distance = (estimate - oracle).abs();
    if distance == 0.0 { 0.0 } else { distance / oracle.abs() * 100.0 }
}

/// Whether an error in percent passes a tolerance in percent; what is not a number does not.
#[must_use]
pub fn passes(error_percent: f64, tolerance_percent: f64) -> bool {
    error_percent <= tolerance_percent
}

/// The largest error; what is not a number counts as the largest of all.
#[must_use]
pub fn worst(errors: impl IntoIterator<Item = f64>) -> f64 {
    errors.into_iter().fold(
        0.0,
        |worst: f64, error| {
            if worst.is_nan() || error.is_nan() { f64::NAN } else { worst.max(error) }
        },
    )
}

#[cfg(test)]
mod tests {
    use super::{error_percent, passes, worst};

    #[test]
    fn a_twentieth_of_a_percent() {
        assert!((error_percent(1.0005, 1.0) - 0.05).abs() < 1e-12);
        assert!((error_percent(-1.0005, -1.0) - 0.05).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_number_never_passes() {
        assert!(!passes(f64::NAN, 1e9));
        assert!(!passes(error_percent(1.0, 0.0), 1e9));
        assert!(passes(error_percent(0.0, 0.0), 0.0));
        assert!(worst([0.1, f64::NAN, 0.2]).is_nan());
        assert!((worst([0.1, 0.3, 0.2]) - 0.3).abs() < f64::EPSILON);
    }
}
