//! What a record's stamps look like.

use crate::line::{Bend, Line};
use crate::lost::Numbers;
use crate::roughness::preference_for_even;

/// What the stamps look like.
#[derive(Debug, Clone, PartialEq)]
pub struct StampStatistics {
    /// Stamps equal to the one before.
    pub repeated: usize,
    /// Groups of equal stamps, single ones included.
    pub groups: usize,
    /// Most samples that share one stamp.
    pub largest_group: usize,
    /// Median time between groups, in seconds.
    pub group_interval_s: f64,
    /// Where no stamp is repeated: steps longer than 1.5 times the median step by more than the stamps
    /// are rounded to, rows without a value counted in. Samples are missing there. None where it is jitter that makes
    /// steps long: their neighbors are then as much too short.
    pub gaps: usize,
    /// The decimal step that stamps are rounded to, in seconds, where there is one.
    pub rounding_s: Option<f64>,
    /// Samples that are missing, where the stamps tell how many: every gap is then whole intervals of an even
    /// clock long. Repeated stamps can tell it too.
    pub lost: usize,
    /// Root mean square distance of the groups' last stamps from an even clock, lost samples counted, in seconds.
    pub deviation_s: f64,
    /// Largest such distance, in seconds.
    pub largest_deviation_s: f64,
    /// Where no stamp is repeated: standard deviation of independent errors of the stamps, from second differences of
    /// their distances from an even clock, rounding included, in seconds. What changes slowly cancels. 0 otherwise.
    pub scatter_s: f64,
    /// Root mean square of the parabola in those distances, in seconds: the logger's clock and the sensor's
    /// change their rates against one another.
    pub bend_s: f64,
    /// The same over its standard error, widened for wander of what is left.
    pub bend_standard_errors: f64,
    /// Largest distance from the parabola, in seconds.
    pub left_by_bend_s: f64,
    /// Standard errors by which the values contradict the stamps more than an even clock; negative where they contradict
    /// the even clock more, 0 where stamps are repeated.
    pub preference_for_even: f64,
}

/// The decimal step that stamps are rounded to.
pub(crate) fn stamp_rounding(stamps: &[f64]) -> Option<f64> {
    // Decimal rounding is what loggers do; a handful of powers of ten is all there is to try.
    let span = stamps.last()? - stamps.first()?;
    (1..=9)
        .map(|digits| 10_f64.powi(digits))
        .find(|scale| {
            let tolerance = 1e-3_f64.max(scale * 4.0 * f64::EPSILON * (span + 1e4));
            tolerance < 0.1
                && stamps.iter().all(|stamp| {
                    let scaled = stamp * scale;
                    (scaled - scaled.round()).abs() <= tolerance
                })
        })
        .map(|scale| 1.0 / scale)
}

/// What the stamps look like, given the numbers of the samples and the line through the groups' ends.
pub(crate) fn statistics(
    stamps: &[f64],
    values: &[f64],
    ends: &[(f64, f64)],
    numbers: &Numbers,
    line: &Line,
) -> StampStatistics {
    let steps: Vec<f64> = ends.iter().zip(ends.iter().skip(1)).map(|(one, next)| next.1 - one.1).collect();
    // Without what rows that hold no value account for.
    let own: Vec<f64> = ends
        .iter()
        .zip(ends.iter().skip(1))
        .zip(&steps)
        .map(|((one, next), step)| step - (next.0 - one.0 - 1.0) * line.slope)
        .collect();
    let usual = middle(&own);
    let largest_group = stamps.chunk_by(|one, next| one == next).map(<[f64]>::len).max();
    let repeated = stamps.len() - ends.len();
    let rounding_s = stamp_rounding(stamps);
    // Stamps that lie on no lattice are not rounded.
    let long = 1.5 * usual + rounding_s.unwrap_or_default().min(0.5 * usual);
    debug_assert_eq!(numbers.ends.len(), ends.len(), "a number for the end of every group");
    // A record may end within a group, whose last sample is not there.
    let whole = numbers.ends.get(..ends.len() - usize::from(repeated > 0)).unwrap_or_default();
    let bend = Bend::of(&Line::through(whole), whole);
    let even: Vec<f64> = numbers.of_samples.iter().map(|number| line.slope * number).collect();
    StampStatistics {
        repeated,
        groups: ends.len(),
        // A record has samples, so that there is a group.
        largest_group: largest_group.unwrap_or_default(),
        group_interval_s: middle(&steps),
        gaps: if repeated == 0 { gaps(&own, usual, long) } else { 0 },
        rounding_s,
        lost: numbers.lost,
        deviation_s: (line.squares() / ends.len() as f64).sqrt(),
        largest_deviation_s: line.residuals.iter().fold(0.0, |most, r| f64::max(most, r.abs())),
        scatter_s: if repeated == 0 { scatter(&numbers.ends, line) } else { 0.0 },
        bend_s: bend.size,
        bend_standard_errors: bend.standard_errors,
        left_by_bend_s: bend.line.residuals.iter().fold(0.0, |most, r| f64::max(most, r.abs())),
        preference_for_even: if repeated == 0 { preference_for_even(stamps, values, &even) } else { 0.0 },
    }
}

/// The upper median of the steps between groups.
fn middle(steps: &[f64]) -> f64 {
    let mut ordered = steps.to_vec();
    ordered.sort_by(f64::total_cmp);
    // Two groups of stamps at least have a step between them.
    ordered.get(ordered.len() / 2).copied().unwrap_or_default()
}

/// Standard deviation of independent errors, from second differences: their variance is six times that of an error.
fn scatter(ends: &[(f64, f64)], line: &Line) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0);
    for (points, errors) in ends.windows(3).zip(line.residuals.windows(3)) {
        if let (&[first, _, last], &[before, own, after]) = (points, errors)
            && last.0 - first.0 < 2.5
            && (last.1 - first.1) < 3.0 * line.slope
        {
            squares += (before - 2.0 * own + after).powi(2);
            count += 1.0;
        }
    }
    if count > 0.0 { (squares / (6.0 * count)).sqrt() } else { 0.0 }
}

/// Steps longer than `long`, unless it is jitter that makes them so.
///
/// A stamp that is late by e makes its step longer by e and the next one shorter by as much: over all long steps the
/// neighbors are short by as much as these are long. A missing sample leaves its neighbors as they are.
fn gaps(steps: &[f64], median: f64, long: f64) -> usize {
    let (mut count, mut excess, mut made_up) = (0, 0.0, 0.0);
    for (index, step) in steps.iter().enumerate().filter(|(_, step)| **step > long) {
        count += 1;
        excess += step - median;
        let before = index.checked_sub(1).and_then(|before| steps.get(before));
        made_up += before.into_iter().chain(steps.get(index + 1)).map(|other| median - other).sum::<f64>();
    }
    if made_up > 0.5 * excess { 0 } else { count }
}

#[cfg(test)]
mod tests {
    use crate::{Clock, ClockChoice, ClockKind, Quantity, Record};

    /// Pseudo-random numbers in −0.5..0.5 without a generator.
    fn noise(index: usize) -> f64 {
        (index as f64 * 12.9898).sin().mul_add(43_758.545_3, 0.0).rem_euclid(1.0) - 0.5
    }

    fn of(stamps: impl Iterator<Item = f64>) -> Clock {
        let stamps: Vec<f64> = stamps.map(|stamp| (stamp * 1e6).round() / 1e6).collect();
        let values = (0..stamps.len()).map(|index| (0.077 * index as f64).sin() + 1e-3 * noise(31 * index));
        let record = Record::new(stamps, values.collect(), None, Quantity::Position, "rad").unwrap();
        Clock::new(&record, ClockChoice::Auto).unwrap()
    }

    /// Uniform errors of width w have the standard deviation w/√12.
    #[test]
    fn scatter_is_that_of_the_errors_whatever_drifts() {
        for change in [0.0, 1e-4] {
            let clock = of((0..6500).map(|index| {
                let time = index as f64 / 260.0;
                time + 0.5 * change * time * time + 3e-4 * noise(index)
            }));
            let scatter = clock.statistics.scatter_s * 12.0_f64.sqrt() / 3e-4;
            assert!((scatter - 1.0).abs() < 0.05, "{scatter}");
        }
    }

    /// Half a change of the rate times the time squared, less its line, is (change/2)·T²·(x² − x + 1/6) for x
    /// = t/T, whose mean square is (change/2)²·T⁴/180.
    #[test]
    fn a_changing_rate_bends_the_stamps() {
        let change = 2e-5;
        let bent = |index: usize| {
            let time = index as f64 / 260.0;
            time + 0.5 * change * time * time
        };
        let clock = of((0..6500).map(bent));
        let expected = 0.5 * change * 625.0 / 180.0_f64.sqrt();
        assert!((clock.statistics.bend_s / expected - 1.0).abs() < 1e-2, "{}", clock.statistics.bend_s);
        assert!(clock.statistics.bend_standard_errors > 100.0);
        assert_eq!(clock.kind, ClockKind::UniformIndex, "{}", clock.reason);
    }

    #[test]
    fn stamps_that_wander_do_not_bend() {
        let mut wander = 0.0;
        let stamps: Vec<f64> = (0..6500)
            .map(|index| {
                wander = 0.998 * wander + 2e-5 * noise(index);
                index as f64 / 260.0 + wander
            })
            .collect();
        let found = of(stamps.into_iter()).statistics;
        assert!(found.bend_standard_errors < 6.594, "{}", found.bend_standard_errors);
    }
}
