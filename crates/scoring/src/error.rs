//! Errors of estimates against the oracle.

/// Returns the relative distance of an estimate from the oracle, in percent: |x − x₀| / |x₀| · 100.
///
/// Infinite if the oracle is zero and the estimate is not; 0 if both are.
#[must_use]
pub fn error_percent(estimate: f64, oracle: f64) -> f64 {
    let distance = (estimate - oracle).abs();
    if distance == 0.0 { 0.0 } else { distance / oracle.abs() * 100.0 }
}

/// Returns `true` if an error in percent is at most a tolerance in percent; NaN never passes.
#[must_use]
pub fn passes(error_percent: f64, tolerance_percent: f64) -> bool {
    error_percent <= tolerance_percent
}

/// Returns the largest error; NaN counts as the largest of all. NaN if there are no errors.
#[must_use]
pub fn worst(errors: impl IntoIterator<Item = f64>) -> f64 {
    let larger =
        |one: f64, other: f64| if one.is_nan() || other.is_nan() { f64::NAN } else { one.max(other) };
    errors.into_iter().reduce(larger).unwrap_or(f64::NAN)
}

/// Returns the median, which is the mean of the middle two for an even number of values. NaN for no values.
#[must_use]
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    let at = |index: usize| sorted.get(index).copied().unwrap_or(f64::NAN);
    let upper = at(sorted.len() / 2);
    if sorted.len() % 2 == 1 { upper } else { f64::midpoint(at((sorted.len() / 2).wrapping_sub(1)), upper) }
}

/// Returns the number of significant digits in which an estimate agrees with the oracle: minus the decimal
/// logarithm of the relative error, limited to the range from 0 to the 15.7 digits of a double. NaN gives 0.
#[must_use]
pub fn digits_of_agreement(error_percent: f64) -> f64 {
    const MOST: f64 = 15.7;
    if error_percent.is_nan() { 0.0 } else { (-(error_percent / 100.0).log10()).clamp(0.0, MOST) }
}

#[cfg(test)]
mod tests {
    use super::{digits_of_agreement, error_percent, median, passes, worst};

    #[test]
    fn a_twentieth_of_a_percent() {
        assert!((error_percent(1.0005, 1.0) - 0.05).abs() < 1e-12);
        assert!((error_percent(-1.0005, -1.0) - 0.05).abs() < 1e-12);
        assert!((error_percent(0.250_125, 0.25) - 0.05).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_number_never_passes() {
        assert!(!passes(f64::NAN, 1e9));
        assert!(!passes(error_percent(1.0, 0.0), 1e9));
        assert!(passes(error_percent(0.0, 0.0), 0.0));
        assert!(worst([0.1, f64::NAN, 0.2]).is_nan());
        assert!((worst([0.1, 0.3, 0.2]) - 0.3).abs() < f64::EPSILON);
    }

    #[test]
    fn digits_are_counted_from_the_relative_error() {
        assert!((digits_of_agreement(0.1) - 3.0).abs() < 1e-12);
        assert!((digits_of_agreement(0.0) - 15.7).abs() < 1e-12);
        assert!(digits_of_agreement(250.0).abs() < 1e-12);
        assert!(digits_of_agreement(f64::NAN).abs() < 1e-12);
    }

    #[test]
    fn the_median_of_even_and_odd_counts() {
        assert!((median([3.0, 1.0, 2.0]) - 2.0).abs() < 1e-12);
        assert!((median([4.0, 1.0, 2.0, 3.0]) - 2.5).abs() < 1e-12);
        assert!((median([1.0, 2.0]) - 1.5).abs() < 1e-12);
        assert!((median([5.0, 1.0, 4.0, 2.0, 3.0]) - 3.0).abs() < 1e-12);
        assert!(median([]).is_nan());
    }
}
