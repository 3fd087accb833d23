//! How smoothly values run on a clock.

/// By how many standard errors the values run more smoothly on the even clock than on the stamps.
///
/// Five neighbors deviate from a cubic by one number, their fourth divided difference scaled to unit
/// noise. On a clock that is wrong by δ it grows by δ times the speed. The squares under either clock are
/// compared in pairs, over stretches that do not overlap. Stamps must increase.
pub(crate) fn preference_for_even(stamps: &[f64], values: &[f64], even: &[f64]) -> f64 {
    let squares = |times: &[f64]| -> Vec<f64> {
        times.chunks_exact(5).zip(values.chunks_exact(5)).map(|(t, y)| off_cubic(t, y).powi(2)).collect()
    };
    let differences: Vec<f64> =
        squares(stamps).iter().zip(squares(even)).map(|(host, even)| host - even).collect();
    let count = differences.len() as f64;
    let mean = differences.iter().sum::<f64>() / count;
    let variance = differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let z = mean / (variance / count).sqrt();
    if z.is_finite() { z } else { 0.0 }
}

/// Distance of points from a cubic, in the noise of a point: Σ cᵢ·yᵢ with cᵢ = 1/Π (tᵢ − tⱼ), scaled to
/// Σ cᵢ² = 1.
pub(crate) fn off_cubic(times: &[f64], values: &[f64]) -> f64 {
    // Relative to the first value, so that values at rest lie on the cubic exactly.
    let origin = values.first().copied().unwrap_or_default();
    let (mut sum, mut norm) = (0.0, 0.0);
    for (at, (&time, &value)) in times.iter().zip(values).enumerate() {
        let product: f64 = times
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != at)
            .map(|(_, other)| time - other)
            .product();
        sum += (value - origin) / product;
        norm += 1.0 / (product * product);
    }
    sum / norm.sqrt()
}
