//! Statistics of a record's stamps.

#![allow(clippy::indexing_slicing, reason = "there is a number for the end of every group")]

use crate::line::{Bend, Line};
use crate::lost::Numbers;
use crate::roughness::preference_for_even;
use crate::statistics::upper_median;
use std::borrow::Cow;

/// Statistics of the stamps.
#[derive(Debug, Clone, PartialEq)]
pub struct StampStatistics {
    /// Number of stamps equal to the one before.
    pub repeated: usize,
    /// Number of groups of equal stamps, including groups of one.
    pub groups: usize,
    /// Largest number of samples with the same stamp.
    pub largest_group: usize,
    /// Median time between groups, in seconds.
    pub group_interval_s: f64,
    /// If no stamp is repeated: number of steps longer than 1.5 times the median step by more than the
    /// rounding of the stamps, with rows without a value counted. Samples are missing there. 0 if jitter
    /// makes the steps long: their neighbors are then too short by as much.
    pub gaps: usize,
    /// Decimal step to which stamps are rounded, in seconds; `None` if there is none.
    pub rounding_s: Option<f64>,
    /// Number of missing samples, if the stamps determine it: every gap is then a whole number of intervals
    /// of an even clock. Repeated stamps can determine it too.
    pub lost: usize,
    /// Root mean square distance of the groups' last stamps from an even clock, with lost samples counted, in
    /// seconds.
    pub deviation_s: f64,
    /// Largest such distance, in seconds.
    pub largest_deviation_s: f64,
    /// If no stamp is repeated: standard deviation of independent errors of the stamps, in seconds. It is
    /// computed from second differences of their distances from an even clock, so slow changes cancel and
    /// rounding is included. 0 otherwise.
    pub scatter_s: f64,
    /// Root mean square of the parabola in those distances, in seconds: a relative drift of the rates of the
    /// logger's and the sensor's clock.
    pub bend_s: f64,
    /// That parabola over its standard error, widened for wander of the remaining distances.
    pub bend_standard_errors: f64,
    /// Largest distance from the parabola, in seconds.
    pub left_by_bend_s: f64,
    /// Number of standard errors by which the values contradict the stamps more than an even clock; negative
    /// if they contradict the even clock more, 0 if stamps are repeated.
    pub preference_for_even: f64,
}

/// Returns the decimal step to which stamps are rounded, or `None` if there is none.
pub(crate) fn stamp_rounding(stamps: &[f64]) -> Option<f64> {
    // Loggers round to decimals, so only a few powers of ten have to be tried.
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

/// Number of standard errors that a preference must exceed: 1 % by chance, one-sided.
pub(crate) const SIGNIFICANT: f64 = 2.33;

/// Share of long steps beyond which scatter of the stamps makes them, if the values agree and no loss is found:
/// stamps that scatter by an interval and are sorted have long steps everywhere.
const SELDOM: f64 = 0.05;

/// Share of repeated stamps up to which they are ties of stamps that scatter, and not bursts: a burst holds several
/// samples.
const TIES: f64 = 0.1;

/// Returns stamps of which few repeat, with those moved apart by a quarter of the `rounding` that made them equal,
/// or by half the way to the next one; returns bursts as they are.
pub(crate) fn without_ties(stamps: &[f64], rounding: Option<f64>) -> Cow<'_, [f64]> {
    let repeats = stamps.iter().zip(stamps.iter().skip(1)).filter(|(one, next)| one == next).count();
    if repeats == 0 || repeats as f64 > TIES * stamps.len() as f64 {
        return Cow::Borrowed(stamps);
    }
    let ends = stamps.chunk_by(|one, next| one == next);
    let next = ends.clone().skip(1).map(<[f64]>::first).chain([None]);
    let apart = ends.zip(next).flat_map(|(group, next)| {
        let count = group.len() as f64;
        group.iter().enumerate().map(move |(at, stamp)| {
            let room = next.map_or(f64::INFINITY, |next| 0.5 * (next - stamp));
            let step = rounding.map_or(room, |rounding| room.min(0.25 * rounding));
            stamp + at as f64 / count * if step.is_finite() { step } else { 0.0 }
        })
    });
    Cow::Owned(apart.collect())
}

/// Computes the statistics of the stamps from the numbers of the samples and the line through the groups'
/// ends. `rounding_s` is the [`stamp_rounding`].
pub(crate) fn statistics(
    stamps: &[f64],
    values: &[f64],
    ends: &[(f64, f64)],
    numbers: &Numbers,
    line: &Line,
    rounding_s: Option<f64>,
) -> StampStatistics {
    let steps: Vec<f64> = ends.iter().zip(ends.iter().skip(1)).map(|(one, next)| next.1 - one.1).collect();
    // Steps without the share of rows that hold no value.
    let own: Vec<f64> = ends
        .iter()
        .zip(ends.iter().skip(1))
        .zip(&steps)
        .map(|((one, next), step)| step - (next.0 - one.0 - 1.0) * line.slope)
        .collect();
    let usual = middle(&own);
    let largest_group = stamps.chunk_by(|one, next| one == next).map(<[f64]>::len).fold(0, usize::max);
    let repeated = stamps.len() - ends.len();
    // Steps of decimals are not exact: the last factor counts all of this length.
    let longest = rounding_s.map_or(1.5 * usual, |step| 1.5 * usual + step.min(0.5 * usual));
    let long = longest * (1.0 - 1e-9);
    debug_assert_eq!(numbers.ends.len(), ends.len(), "a number for the end of every group");
    // A record may end within a group, whose last sample is then missing.
    let whole = &numbers.ends[..ends.len() - usize::from(repeated > 0)];
    let bend = Bend::of(&Line::through(whole), whole);
    let even: Vec<f64> = numbers.of_samples.iter().map(|number| line.slope * number).collect();
    let preference = if repeated == 0 { preference_for_even(stamps, values, &even) } else { 0.0 };
    let gaps = if repeated == 0 { gaps(&own, usual, long) } else { 0 };
    let is_scatter =
        numbers.lost == 0 && gaps as f64 > SELDOM * stamps.len() as f64 && preference > SIGNIFICANT;
    StampStatistics {
        repeated,
        groups: ends.len(),
        largest_group,
        group_interval_s: middle(&steps),
        gaps: if is_scatter { 0 } else { gaps },
        rounding_s,
        lost: numbers.lost,
        deviation_s: (line.squares() / ends.len() as f64).sqrt(),
        largest_deviation_s: line.residuals.iter().fold(0.0, |most, r| f64::max(most, r.abs())),
        scatter_s: if repeated == 0 { scatter(&numbers.ends, line) } else { 0.0 },
        bend_s: bend.size,
        bend_standard_errors: bend.standard_errors,
        left_by_bend_s: bend.line.residuals.iter().fold(0.0, |most, r| f64::max(most, r.abs())),
        preference_for_even: preference,
    }
}

/// Returns the upper median of the steps between groups; 0 without a step.
fn middle(steps: &[f64]) -> f64 {
    upper_median(steps.to_vec()).unwrap_or_default()
}

/// Returns the standard deviation of independent errors from second differences, whose variance is six times
/// that of one error.
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

/// Counts steps longer than `long`, unless jitter makes them long.
///
/// A stamp that is late by e makes its own step longer by e and the next one shorter by e. Over all long
/// steps, the neighbors are then too short by as much as the long steps are too long. A missing sample leaves
/// its neighbors unchanged.
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

    /// Returns pseudo-random numbers in −0.5..0.5 without a generator.
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

    /// (change/2)·t² minus its regression line is (change/2)·T²·(x² − x + 1/6) for x = t/T, with mean square
    /// (change/2)²·T⁴/180.
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

    /// Stamps in milliseconds that scatter by a third of their interval: some are equal, and none is of a burst.
    #[test]
    fn ties_of_scattered_stamps_are_no_bursts() {
        let mut stamps: Vec<f64> = (0..2000)
            .map(|index| ((index as f64 / 100.0 + 1.2e-2 * noise(index)) * 1e3).round() / 1e3)
            .collect();
        stamps.sort_by(f64::total_cmp);
        let ties = stamps.windows(2).filter(|w| w[0] == w[1]).count();
        assert!(ties > 5, "{ties}");
        let found = of(stamps.into_iter());
        assert_eq!(found.statistics.repeated, 0);
        assert!(found.times_s.windows(2).all(|w| w[1] > w[0]), "{}", found.reason);
        let bursts = of((0..2000).map(|index| f64::from(index / 4) * 0.04));
        assert_eq!(bursts.statistics.repeated, 1500);
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
