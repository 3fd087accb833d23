//! Detection of lines that a file contains twice, as merged exports do.

use std::collections::BTreeSet;

/// Returns the indices of samples that repeat the previous sample, stamp and cells alike. Returns an empty
/// set if any stamp repeats with different cells: samples that arrive in bursts share their stamps, and at
/// rest also their values.
pub(crate) fn copies(stamps: &[f64], values: &[Option<f64>], input: &[f64]) -> BTreeSet<usize> {
    let repeats = |at: &usize| stamps.get(*at) == stamps.get(at - 1);
    let is_copy = |at: &usize| values.get(*at) == values.get(at - 1) && input.get(*at) == input.get(at - 1);
    let repeated: BTreeSet<usize> = (1..stamps.len()).filter(repeats).collect();
    // A clock that stands still does not indicate copies.
    let stands_still = repeated.len() + 1 >= stamps.len();
    if !stands_still && repeated.iter().all(is_copy) { repeated } else { BTreeSet::new() }
}

#[cfg(test)]
mod tests {
    use super::copies;

    #[test]
    fn copies_are_told_from_bursts() {
        let values = [0.1, 0.1, 0.2, 0.3, 0.3].map(Some);
        assert_eq!(copies(&[0.0, 0.0, 1.0, 2.0, 2.0], &values, &[]).into_iter().collect::<Vec<_>>(), [1, 4]);
        assert!(copies(&[0.0, 0.0, 0.0, 2.0, 2.0], &values, &[]).is_empty(), "a burst");
        assert!(copies(&[0.0, 0.0, 1.0, 2.0, 2.0], &values, &[1.0, 2.0, 1.0, 1.0, 1.0]).is_empty());
        assert!(copies(&[0.0, 1.0, 2.0, 3.0, 4.0], &values, &[]).is_empty());
        assert!(
            copies(&[1.0, 1.0, 1.0], &[0.1, 0.1, 0.1].map(Some), &[]).is_empty(),
            "a clock that stands still"
        );
        assert!(copies(&[], &[], &[]).is_empty());
    }
}
