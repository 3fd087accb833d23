//! Gap budget: shares of the gap by cause, which add up to 1.

#![allow(clippy::indexing_slicing, reason = "columns are those of the dictionary")]

use crate::evidence::shapley::shapley;
use crate::linear::dictionary::Dictionary;
use crate::matrices::{ridged, solve};
use dynamics::Class;
use nalgebra::DMatrix;
use results::BudgetShares;

/// Classes in the order of the budget.
pub(crate) const CLASSES: [Class; 5] =
    [Class::Dissipative, Class::Conservative, Class::TimeDependent, Class::Sensor, Class::Clock];

/// Returns the sum of squares that all columns of some classes would explain together, to first order.
/// `classes` is a bit set over [`CLASSES`].
fn explained(dictionary: &Dictionary, classes: usize) -> f64 {
    let columns: Vec<usize> = dictionary
        .entries
        .iter()
        .filter(|entry| {
            let class = CLASSES.iter().position(|class| *class == entry.candidate.class());
            class.is_some_and(|class| classes & (1 << class) != 0)
        })
        .flat_map(|entry| entry.columns.clone())
        .collect();
    if columns.is_empty() {
        return 0.0;
    }
    let products = dictionary.products.select_rows(&columns).select_columns(&columns);
    // Neighbors on a grid of shapes are nearly dependent; a small ridge distributes the gain among them.
    let products = ridged(&products, 0..columns.len(), 1e-4);
    let scores = DMatrix::from_iterator(columns.len(), 1, columns.iter().map(|&c| dictionary.scores[c]));
    solve(&products, &scores).map_or(0.0, |solution| solution.dot(&scores).max(0.0))
}

/// Computes the budget. The squares that named effects explain go to their classes. The left-over beyond the
/// noise is distributed among the classes by Shapley values on the dictionary at the repaired fit.
///
/// `named` holds class and squares of each named effect; `left` is the sum of squares beyond the noise that
/// they leave.
pub(crate) fn budget(named: &[(Class, f64)], left: f64, dictionary: Option<&Dictionary>) -> BudgetShares {
    let mut shares = [0.0; 5];
    for (class, squares) in named {
        for (own, share) in CLASSES.iter().zip(&mut shares) {
            if own == class {
                *share += squares.max(0.0);
            }
        }
    }
    if let Some(dictionary) = dictionary.filter(|_| left > 0.0) {
        let generic: Vec<f64> = shapley(CLASSES.len(), &|set| explained(dictionary, set))
            .into_iter()
            .map(|share| share.max(0.0))
            .collect();
        let total: f64 = generic.iter().sum();
        if total > 0.0 {
            for (share, generic) in shares.iter_mut().zip(generic) {
                *share += left * generic / total;
            }
        }
    }
    let total: f64 = shares.iter().sum();
    if total <= 0.0 {
        return BudgetShares::default();
    }
    let [dissipative, conservative, time_dependent, sensor, clock] = shares.map(|share| share / total);
    BudgetShares { dissipative, conservative, time_dependent, sensor, clock }
}

#[cfg(test)]
mod tests {
    use super::shapley;

    /// The glove game: one left glove, two right ones; a pair is worth 1. The values are 2/3, 1/6, 1/6.
    #[test]
    fn the_glove_game() {
        let values = shapley(3, &|set| f64::from(set & 1 == 1 && set & 6 != 0));
        for (value, expected) in values.iter().zip([2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0]) {
            assert!((value - expected).abs() < 1e-15);
        }
    }
}
