//! How noisy a record is, without a model of its motion.

use crate::envelope::median;

/// Standard deviation of white noise, from the median size of the fourth differences.
///
/// A motion of angular frequency ω sampled every Δ contributes (ωΔ)⁴ of its amplitude, which vanishes
/// against noise for any record with some twenty samples a period; the median ignores the few places
/// where something else happens. White noise of variance σ² has fourth differences of variance 70 σ².
/// Quantized values at rest give 0: add the quantum where it is known.
#[must_use]
pub fn noise_level(values: &[f64]) -> f64 {
    let sizes: Vec<f64> = values
        .windows(5)
        .filter_map(|part| match part {
            &[a, b, c, d, e] => Some((a - 4.0 * b + 6.0 * c - 4.0 * d + e).abs()),
            _ => None,
        })
        .collect();
    // The median size of a Gaussian is 0.6745 standard deviations. Fewer than five values tell no noise.
    median(sizes).unwrap_or(0.0) / 0.674_489_750_196_081_7 / 70_f64.sqrt()
}
