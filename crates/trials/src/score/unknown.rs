//! Detection of laws without a name (`unknown`).

use super::accuracy::{SIZES, range, within};
use super::judgment::Judgment;
use super::statistics::area;
use crate::hidden::{Asked, Bank};
use results::{AreaRow, UnknownStudy, VerdictStatus};

/// Largest number of points kept of the curve.
const MOST_POINTS: usize = 200;

/// Returns the areas under the ROC curve of the stated probability of `unknown`. Positives are cases whose
/// effect was not to be considered or lies outside the vocabulary; negatives are cases with named effects or
/// none.
pub(crate) fn study(judged: &[Judgment<'_>]) -> UnknownStudy {
    let score = |judgment: &Judgment<'_>| judgment.probability(VerdictStatus::Unknown.name());
    let is_negative = |bank: Bank| matches!(bank, Bank::None | Bank::Calibration | Bank::Single | Bank::Pair);
    let negatives: Vec<f64> =
        judged.iter().filter(|judgment| is_negative(judgment.bank())).filter_map(score).collect();
    let of = |size: Option<f64>, wanted: &dyn Fn(&Judgment<'_>) -> bool| {
        let positives: Vec<f64> = judged
            .iter()
            .filter(|judgment| judgment.asked() == Asked::Unknown && wanted(judgment))
            .filter_map(score)
            .collect();
        let row = AreaRow {
            size,
            positives: positives.len() as u64,
            negatives: negatives.len() as u64,
            area: area(&positives, &negatives)?,
        };
        Some((row, positives))
    };
    let all = of(None, &|_| true);
    let curve = all.as_ref().map_or_else(Vec::new, |(_, positives)| curve(positives, &negatives));
    let by_size = SIZES.iter().enumerate().filter_map(|(index, size)| {
        of(Some(*size), &|judgment| within(judgment.size(), range(index))).map(|found| found.0)
    });
    UnknownStudy { areas: all.iter().map(|found| found.0.clone()).chain(by_size).collect(), curve }
}

/// Returns false alarms and hits over all thresholds, from none to all.
fn curve(positives: &[f64], negatives: &[f64]) -> Vec<[f64; 2]> {
    let mut thresholds: Vec<f64> = positives.iter().chain(negatives).copied().collect();
    thresholds.sort_by(|a, b| b.total_cmp(a));
    thresholds.dedup();
    let stride = thresholds.len().div_ceil(MOST_POINTS).max(1);
    let share = |values: &[f64], threshold: f64| {
        values.iter().filter(|value| **value >= threshold).count() as f64 / values.len().max(1) as f64
    };
    let inside = thresholds
        .into_iter()
        .step_by(stride)
        .map(|threshold| [share(negatives, threshold), share(positives, threshold)]);
    [[0.0, 0.0]].into_iter().chain(inside).chain([[1.0, 1.0]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_bounds_the_area() {
        let (positives, negatives) = ([0.9, 0.8, 0.4], [0.5, 0.3, 0.2, 0.1]);
        let points = curve(&positives, &negatives);
        assert_eq!((points[0], points[points.len() - 1]), ([0.0, 0.0], [1.0, 1.0]));
        let trapezoids: f64 =
            points.windows(2).map(|pair| (pair[1][0] - pair[0][0]) * 0.5 * (pair[0][1] + pair[1][1])).sum();
        assert!((trapezoids - area(&positives, &negatives).unwrap().value).abs() < 1e-12);
    }
}
