//! Noise level of a record, without a model of its motion.

use crate::envelope::median;

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
    // The median size of a Gaussian is 0.6745 standard deviations. Fewer than five values have no fourth
    // difference.
    median(sizes).unwrap_or(0.0) / 0.674_489_750_196_081_7 / 70_f64.sqrt()
}
