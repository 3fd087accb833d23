//! What the best of many candidates gains by chance.

use crate::dictionary::Dictionary;
use crate::search::singles;
use crate::statistics::quantile;
use nalgebra::DVector;
use rand_distr::{Distribution, StandardNormal};
use seed::Seed;

/// Draws of the null.
const DRAWS: usize = 1000;

/// The largest gain of a single candidate, in noise variances, that is exceeded with a given probability where the
/// calibrated simulator is right and the noise white.
///
/// A parametric bootstrap in the space of the scores: under the null they are Gaussian with the dictionary's products as
/// covariance, exactly so for Gaussian noise on this record's own times. The maximum runs over every candidate,
/// shape and sign that the search looks at.
pub(crate) fn threshold(dictionary: &Dictionary, probability: f64, seed: &Seed) -> f64 {
    let width = dictionary.columns.ncols();
    if width == 0 {
        return crate::statistics::chi_squared_above(1.0, probability);
    }
    let mut products = dictionary.products.clone();
    let largest = products.diagonal().max();
    for i in 0..width {
        // Columns of one grid are nearly dependent; the factorization needs a whisker more.
        products[(i, i)] *= 1.0 + 1e-9;
        products[(i, i)] += 1e-12 * largest;
    }
    let Some(factor) = products.cholesky().map(|c| c.l()) else {
        return crate::statistics::chi_squared_above(1.0, probability / width as f64);
    };
    let mut generator = seed.child("null").generator();
    let mut drawn = dictionary.clone();
    let gains: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let white = DVector::from_fn(width, |_, _| StandardNormal.sample(&mut generator));
            drawn.scores = &factor * white;
            singles(&drawn).first().map_or(0.0, |gain| gain.squares)
        })
        .collect();
    quantile(&gains, 1.0 - probability)
}
