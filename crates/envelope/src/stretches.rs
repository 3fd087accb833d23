//! Stretches of a record without a gap: samples on both sides of a gap are no neighbors.

use record::median;
use std::ops::Range;

/// Longest step between samples that is no gap, in usual steps: after a lost sample or two the neighbors are
/// near enough.
const STEPS: f64 = 3.0;

/// Cuts samples at steps in time that are longer than `longest` and longer than three usual steps. Repeated
/// times, as in a burst, do not count for the usual step. Without a gap the result is one range of all
/// samples.
pub(crate) fn stretches(times: &[f64], longest: f64) -> Vec<Range<usize>> {
    let steps = || times.iter().zip(times.iter().skip(1)).map(|(one, next)| next - one);
    // Samples at a single time have no gap.
    let usual = median(steps().filter(|step| *step > 0.0).collect()).unwrap_or(f64::INFINITY);
    let limit = longest.max(STEPS * usual * (1.0 + 1e-9));
    let cuts = steps().enumerate().filter(|(_, step)| *step > limit).map(|(at, _)| at + 1);
    let ends = cuts.chain([times.len()]);
    ends.scan(0, |from, to| Some(std::mem::replace(from, to)..to)).collect()
}

#[cfg(test)]
mod tests {
    use super::stretches;

    /// Returns the first index of each stretch and the index after its last.
    fn cut(times: &[f64], longest: f64) -> Vec<(usize, usize)> {
        stretches(times, longest).into_iter().map(|range| (range.start, range.end)).collect()
    }

    #[test]
    fn cuts_at_gaps_and_nowhere_else() {
        let even: Vec<f64> = (0..10).map(f64::from).collect();
        assert_eq!(cut(&even, 0.5), [(0, 10)]);
        let hole = [0.0, 1.0, 2.0, 3.0, 7.0, 8.0, 9.0, 12.0, 13.0];
        assert_eq!(cut(&hole, 0.5), [(0, 4), (4, 9)], "three steps leave neighbors");
        assert_eq!(cut(&hole, 4.0), [(0, 9)]);
        let bursts = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 6.0];
        assert_eq!(cut(&bursts, 0.5), [(0, 8), (8, 9)]);
    }
}
