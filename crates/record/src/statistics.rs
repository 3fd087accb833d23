//! Statistics of a series that need no model of its motion.

/// Returns the lowest and the highest of some values; infinite, and in the wrong order, without a value.
///
/// ```
/// assert_eq!(record::extremes(&[0.2, -1.0, 3.0]), [-1.0, 3.0]);
/// ```
#[must_use]
pub fn extremes(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lowest, highest], value| {
        [lowest.min(*value), highest.max(*value)]
    })
}

/// Returns the median, which is the mean of the middle two for an even number of values; `None` without a
/// value.
#[must_use]
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    let upper = *values.get(middle)?;
    if values.len() % 2 == 1 {
        return Some(upper);
    }
    Some((values.get(middle.checked_sub(1)?)? + upper) / 2.0)
}

/// Returns the upper median, which is one of the values; `None` without a value.
pub(crate) fn upper_median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Returns the standard deviation of white noise, from the median size of the fourth differences.
///
/// A motion of angular frequency ω sampled at intervals Δ contributes (ωΔ)⁴ of its amplitude, which is
/// negligible against noise for a record with about twenty samples per period. The median ignores the few
/// places that are different. White noise of variance σ² has fourth differences of variance 70 σ². Quantized
/// values at rest give 0: add the quantum if it is known. 0 for fewer than five values.
#[must_use]
pub fn noise_level(values: &[f64]) -> f64 {
    let sizes: Vec<f64> = values
        .windows(5)
        .filter_map(|part| match part {
            &[a, b, c, d, e] => Some((a - 4.0 * b + 6.0 * c - 4.0 * d + e).abs()),
            _ => None,
        })
        .collect();
    // Fewer than five values have no fourth difference.
    let Some(size) = median(sizes) else { return 0.0 };
    // The median size of a Gaussian is 0.6745 standard deviations.
    size / 0.674_489_750_196_081_7 / 70_f64.sqrt()
}
