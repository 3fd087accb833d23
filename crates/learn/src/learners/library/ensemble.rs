//! Inclusion shares of terms, by an ensemble of resampled regressions.
//!
//! Fasel, Kutz, Brunton, Brunton, Proceedings of the Royal Society A 478 (2022) 20210904.

#![allow(clippy::indexing_slicing, reason = "the list grows up to the group")]

use super::{Regression, thresholded};
use rand::RngExt;
use seed::Seed;

/// Returns the share of `members` resampled regressions that keep each term. Groups of rows are drawn with
/// replacement.
#[must_use]
pub fn inclusion(regression: &Regression, threshold: f64, members: usize, seed: &Seed) -> Vec<f64> {
    let mut by_group: Vec<Vec<usize>> = Vec::new();
    for (row, &group) in regression.groups.iter().enumerate() {
        if by_group.len() <= group {
            by_group.resize(group + 1, Vec::new());
        }
        by_group[group].push(row);
    }
    let mut counts = vec![0_usize; regression.terms.len()];
    let mut generator = seed.child("ensemble").generator();
    for _ in 0..members {
        let drawn = (0..by_group.len()).map(|_| generator.random_range(0..by_group.len()));
        let rows: Vec<usize> = drawn.filter_map(|group| by_group.get(group)).flatten().copied().collect();
        let weights = thresholded(&regression.selected(&rows), threshold);
        for (count, weight) in counts.iter_mut().zip(&weights) {
            *count += usize::from(*weight != 0.0);
        }
    }
    counts.iter().map(|&count| count as f64 / members.max(1) as f64).collect()
}
