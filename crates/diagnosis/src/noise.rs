//! The noise floor, measured from a residual.

use crate::segments::{Data, Segment};
use crate::statistics::normal_above;
use nalgebra::DVector;
use serde::Serialize;

/// Fewest second differences of a moving signal that a floor is taken from.
const FEWEST: f64 = 100.0;

/// Standard deviation of the white part of a residual.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NoiseFloor {
    /// s₀ with s₀² = mean((e₍ᵢ₋₁₎ − 2eᵢ + e₍ᵢ₊₁₎)²)/6, in the observed quantity's unit. Quantization is part of it.
    pub value: f64,
    /// 95 % interval.
    pub interval_95: [f64; 2],
    /// Second differences used.
    pub count: usize,
}

/// The floor from second differences of a residual.
///
/// A smooth misfit cancels in second differences, white noise does not: their variance is 6·s₀². A quantized signal at
/// rest shows one value over and over and no noise at all, so that only stretches count where the signal moves
/// by a resolution step or more between samples (all, if those are too few).
///
/// The interval follows from the variance of the mean of squares: second differences of white Gaussian noise have
/// correlations −2/3 and 1/6, so that n of them are worth n/(1 + 2·(4/9 + 1/36)) independent ones.
pub(crate) fn floor(data: &Data, residuals: &[DVector<f64>]) -> NoiseFloor {
    let by_segment = squares(data, residuals);
    let count = by_segment.iter().map(|own| own.1).sum::<f64>();
    let variance = by_segment.iter().map(|own| own.0).sum::<f64>() / count.max(1.0);
    let worth = count / (1.0 + 2.0 * (4.0 / 9.0 + 1.0 / 36.0));
    let spread = normal_above(0.025) * (2.0 / worth.max(1.0)).sqrt();
    let end = |factor: f64| (variance * factor.max(0.0)).sqrt();
    NoiseFloor {
        value: variance.sqrt(),
        interval_95: [end(1.0 - spread), end(1.0 + spread)],
        count: count as usize,
    }
}

/// For each segment, a sixth of the sum of the squared second differences that count, and how many do.
pub(crate) fn squares(data: &Data, residuals: &[DVector<f64>]) -> Vec<(f64, f64)> {
    let step = data.resolution.unwrap_or(0.0);
    let sums = |only_moving: bool| -> Vec<(f64, f64)> {
        let pieces = data.segments.iter().zip(residuals);
        let own = |(segment, residual): (&Segment, &DVector<f64>)| {
            let (mut sum, mut count) = (0.0, 0.0);
            for (e, y) in residual.as_slice().windows(3).zip(segment.values.windows(3)) {
                if let (&[a, b, c], &[first, _, last]) = (e, y)
                    && (!only_moving || (last - first).abs() >= 2.0 * step)
                {
                    sum += (a - 2.0 * b + c).powi(2) / 6.0;
                    count += 1.0;
                }
            }
            (sum, count)
        };
        pieces.map(own).collect()
    };
    let moving = sums(true);
    if moving.iter().map(|own| own.1).sum::<f64>() >= FEWEST { moving } else { sums(false) }
}
