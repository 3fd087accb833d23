//! Shapley values: what each of several causes contributes.

#![allow(clippy::indexing_slicing, reason = "there is a worth for every set")]

/// Computes the Shapley values of `count` players: the mean, over all orders in which they can join, of what
/// each adds. `worth` maps a set, as bits, to its worth.
///
/// # Reference
/// Shapley, in Contributions to the Theory of Games II, Princeton 1953, 307.
pub(crate) fn shapley(count: usize, worth: &dyn Fn(usize) -> f64) -> Vec<f64> {
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    let sets = 1_usize << count;
    let worths: Vec<f64> = (0..sets).map(worth).collect();
    (0..count)
        .map(|player| {
            (0..sets)
                .filter(|set| set & (1 << player) == 0)
                .map(|set| {
                    let size = set.count_ones() as usize;
                    let weight = factorial(size) * factorial(count - size - 1) / factorial(count);
                    weight * (worths[set | (1 << player)] - worths[set])
                })
                .sum()
        })
        .collect()
}
