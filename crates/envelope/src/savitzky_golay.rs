//! Smoothing by local polynomials.

#![allow(clippy::indexing_slicing, reason = "a window longer than the values is refused")]

use crate::error::EnvelopeError;
use nalgebra::{DMatrix, DVector};

/// Smooths values by Savitzky and Golay's method: each sample becomes the middle value of the polynomial of
/// the given order fitted to the `window` samples around it. At either end the polynomial of the outermost
/// full window is used, as in scipy's mode `interp`.
///
/// A window of 0 or 1 leaves the values unchanged.
///
/// # Errors
/// [`EnvelopeError::SmoothingWindow`] unless the window is odd, above the order and at most the number
/// of values.
///
/// # Reference
/// Savitzky, Golay, Analytical Chemistry 36 (1964) 1627.
pub fn savitzky_golay(values: &[f64], window: usize, order: usize) -> Result<Vec<f64>, EnvelopeError> {
    if window <= 1 {
        return Ok(values.to_vec());
    }
    let misfit = EnvelopeError::SmoothingWindow { window, order, samples: values.len() };
    if window.is_multiple_of(2) || order >= window || window > values.len() {
        return Err(misfit);
    }
    // Powers of the position in -1..1 are well scaled for any window.
    let half = (window / 2) as f64;
    let design =
        DMatrix::from_fn(window, order + 1, |row, power| ((row as f64 - half) / half).powi(power as i32));
    // Row i of the projection gives the fitted value at position i of the window.
    let pseudo_inverse = design.clone().pseudo_inverse(1e-13).map_err(|_| misfit)?;
    let projection = &design * pseudo_inverse;
    let middle = window / 2;
    let center: Vec<f64> = projection.row(middle).iter().copied().collect();
    let inner = values
        .windows(window)
        .map(|part| part.iter().zip(&center).map(|(value, weight)| value * weight).sum::<f64>());
    let end = |part: &[f64]| -> Vec<f64> {
        let fitted = &projection * DVector::from_row_slice(part);
        fitted.iter().copied().collect()
    };
    let (head, tail) = (end(&values[..window]), end(&values[values.len() - window..]));
    Ok(head.into_iter().take(middle).chain(inner).chain(tail.into_iter().skip(middle + 1)).collect())
}

#[cfg(test)]
mod tests {
    use super::savitzky_golay;

    #[test]
    fn a_cubic_passes_unchanged_ends_included() {
        let cubic: Vec<f64> = (0..40).map(|i| (i as f64 * 0.1 - 2.0).powi(3)).collect();
        let smooth = savitzky_golay(&cubic, 11, 3).unwrap();
        for (before, after) in cubic.iter().zip(&smooth) {
            assert!((before - after).abs() < 1e-12);
        }
    }

    #[test]
    fn the_center_weights_are_the_published_ones() {
        // Savitzky and Golay's table for 5 points, quadratic: (-3, 12, 17, 12, -3)/35.
        let mut pulse = [0.0; 11];
        pulse[5] = 35.0;
        let smooth = savitzky_golay(&pulse, 5, 2).unwrap();
        let expected = [-3.0, 12.0, 17.0, 12.0, -3.0];
        for (found, expected) in smooth[3..8].iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{smooth:?}");
        }
    }

    #[test]
    fn an_unfit_window_is_refused() {
        for (window, order) in [(4, 2), (5, 5), (101, 3)] {
            let message = savitzky_golay(&[0.0; 50], window, order).unwrap_err().to_string();
            assert!(message.contains("does not fit 50 samples"), "{message}");
        }
    }
}
