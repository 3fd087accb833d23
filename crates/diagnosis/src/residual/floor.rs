//! Noise floor, measured from a residual.

use crate::data::segments::{Data, Segment};
use crate::noise::rounding::{Rounded, rounded};
use crate::noise::statistics::{normal_above, sixths};
use nalgebra::DVector;

/// Standard deviation of the white part of a residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NoiseFloor {
    /// s₀ with s₀² = mean((e₍ᵢ₋₁₎ − 2eᵢ + e₍ᵢ₊₁₎)²)/6, in the observed quantity's unit. It includes
    /// quantization.
    pub(crate) value: f64,
    /// Lower and upper end of the 95 % interval.
    pub(crate) interval_95: [f64; 2],
    /// Number of second differences used.
    pub(crate) count: usize,
}

/// Computes the floor from second differences of a residual.
///
/// A smooth misfit cancels in second differences; white noise does not: their variance is 6·s₀². In readings
/// rounded to steps they show too little noise where the motion is slow. The effect of rounding on the
/// differences of this motion is computed and corrected ([`crate::noise::rounding`]).
///
/// The interval follows from the variance of the mean of squares: second differences of white Gaussian noise
/// have correlations −2/3 and 1/6, so that n of them are worth n/(1 + 2·(4/9 + 1/36)) independent ones.
pub(crate) fn floor(data: &Data, residuals: &[DVector<f64>]) -> NoiseFloor {
    of_squares(&squares(data, residuals))
}

/// Computes the floor from the [`squares`] of a residual.
pub(crate) fn of_squares(squares: &[Vec<Option<f64>>]) -> NoiseFloor {
    let count = squares.iter().flatten().flatten().count() as f64;
    let variance = squares.iter().flatten().flatten().sum::<f64>() / count.max(1.0);
    let worth = count / (1.0 + 2.0 * (4.0 / 9.0 + 1.0 / 36.0));
    let spread = normal_above(0.025) * (2.0 / worth.max(1.0)).sqrt();
    let end = |factor: f64| (variance * factor.max(0.0)).sqrt();
    NoiseFloor {
        value: variance.sqrt(),
        interval_95: [end(1.0 - spread), end(1.0 + spread)],
        count: count as usize,
    }
}

/// Returns, for each sample of each segment but the outermost, a sixth of the squared second difference about
/// it. Their mean is the variance of a sample; the effect of rounding is corrected.
pub(crate) fn squares(data: &Data, residuals: &[DVector<f64>]) -> Vec<Vec<Option<f64>>> {
    let mut squares: Vec<_> = residuals.iter().map(|residual| sixths(residual.as_slice())).collect();
    if let Some(rounded) = rounded_as(data, residuals, &squares) {
        for square in squares.iter_mut().flatten().flatten() {
            *square *= rounded.factor;
        }
    }
    squares
}

/// Returns what the sensor's steps do to the readings; `None` if it has none.
fn rounded_as(data: &Data, residuals: &[DVector<f64>], squares: &[Vec<Option<f64>>]) -> Option<Rounded> {
    let pieces = data.segments.iter().zip(residuals);
    let pieces: Vec<(&[f64], &[f64])> =
        pieces.map(|(segment, residual)| (segment.values.as_slice(), residual.as_slice())).collect();
    rounded(&pieces, data.resolution?, of_squares(squares).value)
}

/// Returns the residual without the mean error of rounding, which depends on the position alone. Where the noise
/// is far below the sensor's steps, that is most of the residual.
pub(crate) fn without_rounding(data: &Data, residuals: &[DVector<f64>]) -> Vec<DVector<f64>> {
    let squares: Vec<_> = residuals.iter().map(|residual| sixths(residual.as_slice())).collect();
    let Some(rounded) = rounded_as(data, residuals, &squares) else { return residuals.to_vec() };
    let of = |(segment, residual): (&Segment, &DVector<f64>)| {
        let pairs = residual.iter().zip(&segment.values);
        DVector::from_iterator(
            residual.len(),
            pairs.map(|(error, value)| error - rounded.bias(value - error)),
        )
    };
    data.segments.iter().zip(residuals).map(of).collect()
}
