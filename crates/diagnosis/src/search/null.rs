//! Null distribution of the largest gain among many candidates.

#![allow(clippy::indexing_slicing, reason = "rows and columns are those of the dictionary")]

use crate::linear::dictionary::Dictionary;
use crate::noise::statistics::quantile;
use crate::search::gains::singles;
use nalgebra::{DMatrix, DVector};
use rand_distr::{Distribution, StandardNormal};
use seed::Seed;

/// Number of draws of the null.
const DRAWS: usize = 1000;

/// Returns the largest gain of a single candidate, in noise variances, that chance exceeds with a given
/// probability if the calibrated simulator is right and the noise white.
///
/// This is a parametric bootstrap in the space of the scores: under the null they are Gaussian with the
/// dictionary's products as covariance, exactly so for Gaussian noise at this record's own times. The maximum
/// runs over every candidate, shape and sign that the dictionary has columns for. A second body has no
/// columns; its lines are charged for separately.
pub(crate) fn threshold(dictionary: &Dictionary, probability: f64, seed: &Seed) -> f64 {
    let width = dictionary.columns.ncols();
    if width == 0 {
        return crate::noise::statistics::chi_squared_above(1.0, probability);
    }
    // The columns are scaled to unit length: their lengths differ by many orders of magnitude. Columns of one
    // grid are nearly dependent, so the root of their products comes from eigenvalues, not from a triangular
    // factor.
    let scale = dictionary.products.diagonal().map(f64::sqrt);
    let cosines = DMatrix::from_fn(width, width, |i, j| {
        let length = scale[i] * scale[j];
        if length > 0.0 { dictionary.products[(i, j)] / length } else { 0.0 }
    });
    let eigen = cosines.symmetric_eigen();
    let mut factor = eigen.eigenvectors;
    for (mut column, value) in factor.column_iter_mut().zip(eigen.eigenvalues.iter()) {
        column *= value.max(0.0).sqrt();
    }
    for (mut row, scale) in factor.row_iter_mut().zip(scale.iter()) {
        row *= *scale;
    }
    let mut generator = seed.child("null").generator();
    let mut drawn = dictionary.clone();
    let gains: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let white = DVector::from_fn(width, |_, _| StandardNormal.sample(&mut generator));
            drawn.scores = &factor * white;
            singles(&drawn).iter().map(|gain| gain.squares).fold(0.0, f64::max)
        })
        .collect();
    quantile(&gains, 1.0 - probability)
}
