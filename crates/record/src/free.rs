//! The part of a record in which the system swings freely, between hands that lift, hold, strike and stop it.

use crate::FEWEST_SAMPLES;
use crate::record::Record;
use crate::recursion::{between_strikes, is_one_motion};
use crate::spikes::without_spikes;
use crate::statistics::{extremes, noise_level, upper_median};

/// A free swing within a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FreeSwing {
    /// Indices of its first and last sample.
    pub(crate) samples: [usize; 2],
    /// Number of its half swings.
    pub(crate) half_swings: usize,
}

impl FreeSwing {
    /// Returns `true` if it has the samples of a record.
    fn is_record(&self) -> bool {
        let [first, last] = self.samples;
        last + 1 - first >= FEWEST_SAMPLES
    }
}

/// Smallest number of half swings of a free swing.
const FEWEST: usize = 5;
/// Part of the largest half swing below which one says nothing about a hand.
const LARGE: f64 = 0.2;
/// Growth of a half swing, as a part of the one before, above which energy came in at once.
const STRUCK: f64 = 1.15;
/// Height of a half swing, as a part of the one before, below which it was stopped, unless the ones before
/// fell as fast.
const STOPPED: f64 = 0.6;
/// Ratio of the durations of neighboring half swings above which they do not belong to one free swing.
const UNEVEN: f64 = 1.6;
/// Difference of their heights, as a part of the larger one, that they have to have as well.
const UNLIKE: f64 = 0.1;
/// Duration of a plateau, in half swings, from which something was held.
const HELD: f64 = 1.25;

/// Part of the time between the first and the last turning point that the free swings have to last.
const MOST: f64 = 0.6;
/// Part of the half swings of a free swing that may be larger than the ones before them.
const RISES: f64 = 0.1;
/// Part of the motion beside the free swings in which half swings are as long as usual, from which it is the
/// same swing, with wrong values or another mode in it, and no hand.
const SWINGS_OUTSIDE: f64 = 0.4;
/// Number of breaks up to which a hand may also have swung it in its own time.
const MANY: usize = 6;
/// Factor between the falls of the last half swings and the median fall before them from which a hand slows
/// the swing: no friction takes more from a small swing than from a large one.
const SLOWED: f64 = 4.0;
/// Duration of missing samples, in half swings, from which a turning point may be missing.
const GAP: f64 = 0.25;

/// Part of a record from which a rest at its beginning is left out. A motion that begins slowly stays within the noise for
/// less.
const REST: f64 = 0.1;
/// Number of half swings within which a motion that something begins at once is large.
const FIRST: usize = 3;

/// A turning point of a record.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turn {
    /// Index of the sample.
    pub(crate) at: usize,
    /// Indices of the first and last sample of the plateau around it.
    pub(crate) plateau: [usize; 2],
}

/// Finds the free swings of a record, if there is something beside them: a change of energy within one half
/// swing (a lift, a strike, a stop), a plateau longer than a half swing, or half swings of uneven duration.
/// Empty for a record with an input, without such a change, or whose free swings are not most of it.
///
/// A free swing is one whose half swings fall; beating and forced ones rise again, are not recognized here
/// and stay whole.
pub(crate) fn free_swings(record: &Record) -> Vec<FreeSwing> {
    if record.input().is_some() {
        return Vec::new();
    }
    // A wrong value looks like a strike and a stop.
    let record = &record.clone().with_values(without_spikes(record.values()));
    let values = record.values();
    let (mut turns, least) = turning_points(values);
    if turns.len() <= FEWEST {
        return after_rest(record, turns.len());
    }
    let whole: Vec<Turn> = turns.clone();
    // A record that begins within a half swing has its first turning point after that.
    let begins_within = HalfSwings::new(record, &turns, least).begins_within();
    turns.drain(..usize::from(begins_within));
    let half_swings = HalfSwings::new(record, &turns, least);
    let breaks = half_swings.breaks();
    let ends = || breaks.iter().copied();
    let starts = std::iter::once(0).chain(ends());
    let pieces = starts.zip(ends().chain([turns.len()]));
    let found: Vec<FreeSwing> =
        pieces.filter_map(|(from, to)| half_swings.free(from, to)).filter(FreeSwing::is_record).collect();
    let stamps = record.stamps_s();
    let between = |[from, to]: [usize; 2]| value(stamps, to) - value(stamps, from);
    let (Some(first), Some(last)) = (turns.first(), turns.last()) else { return Vec::new() };
    // What is held does not move.
    let held = (0..turns.len()).filter(|number| half_swings.is_held(*number));
    let held = held.filter_map(|number| turns.get(number)).map(|turn| {
        let [from, to] = turn.plateau;
        between([from.max(first.at), to.min(last.at)])
    });
    let moves = between([first.at, last.at]) - held.sum::<f64>();
    let is_most = found.iter().map(|swing| between(swing.samples)).sum::<f64>() > MOST * moves;
    let is_whole = found.iter().any(|swing| swing.samples == [0, values.len() - 1]);
    // Each strike breaks the motion twice: at its last turning point before, and at the first one after.
    let is_swing = breaks.len() > MANY.max(2 * found.len())
        && half_swings.regular_outside(&found) > SWINGS_OUTSIDE
        || half_swings.goes_on_after(&found);
    let is_cut = is_most && !is_whole && !is_swing;
    // Beside another mode half swings are as uneven as beside a hand.
    let [_, half_swing] = half_swings.usual;
    if is_cut && !is_one_motion(values, half_swing) {
        return found;
    }
    // Rows are not even in time where some are missing.
    let usual = between([0, values.len() - 1]) / (values.len() - 1) as f64;
    let is_even = stamps.iter().zip(stamps.iter().skip(1)).all(|(one, next)| next - one < 2.0 * usual);
    let pieces = if is_even { between_strikes(values, half_swing) } else { Vec::new() };
    let found: Vec<FreeSwing> =
        pieces.into_iter().filter_map(|samples| half_swings.between(samples)).collect();
    if found.is_empty() && begins_large(record, &whole) { after_rest(record, whole.len()) } else { found }
}

/// Returns `true` if one of the first half swings of a record is no less than half the largest.
fn begins_large(record: &Record, turns: &[Turn]) -> bool {
    let at = |turn: &Turn| value(record.values(), turn.at);
    let heights = turns.iter().zip(turns.iter().skip(1)).map(|(one, next)| (at(next) - at(one)).abs());
    let largest = heights.clone().fold(0.0, f64::max);
    heights.take(FIRST).any(|height| height > 0.5 * largest)
}

/// Returns the motion after a rest if a record begins with one: the answer to a step, a release or a strike.
fn after_rest(record: &Record, half_swings: usize) -> Vec<FreeSwing> {
    let (held, samples) = (record.samples_at_rest(), record.len());
    let is_rest = held as f64 > REST * samples as f64;
    let motion = FreeSwing { samples: [held, samples - 1], half_swings };
    if is_rest && motion.is_record() { vec![motion] } else { Vec::new() }
}

/// Returns the turning points of a series: extremes from which it turns back by eight times its noise and a
/// thirtieth of its range at least. Returns that height as well.
pub(crate) fn turning_points(values: &[f64]) -> (Vec<Turn>, f64) {
    let [lowest, highest] = extremes(values);
    let noise = noise_level(values);
    let least = (8.0 * noise).max((highest - lowest) / 30.0);
    let (mut found, mut side) = (Vec::new(), 0.0);
    let (mut high, mut low) = ((0, f64::NEG_INFINITY), (0, f64::INFINITY));
    for (at, value) in values.iter().copied().enumerate() {
        if value > high.1 {
            high = (at, value);
        }
        if value < low.1 {
            low = (at, value);
        }
        if side >= 0.0 && high.1 - value > least {
            found.push(high.0);
            (side, low) = (-1.0, (at, value));
        } else if side <= 0.0 && value - low.1 > least {
            found.push(low.0);
            (side, high) = (1.0, (at, value));
        }
    }
    let within = |at: usize| {
        let beside =
            |other: Option<&usize>| other.map(|other| (value(values, *other) - value(values, at)).abs());
        let index = found.partition_point(|other| *other < at);
        let before = index.checked_sub(1).and_then(|index| found.get(index));
        let heights = [beside(before), beside(found.get(index + 1))];
        let height = heights.into_iter().flatten().fold(f64::INFINITY, f64::min);
        let band = 0.02 * height.min(highest - lowest) + 6.0 * noise;
        let near = |other: &usize| (value(values, *other) - value(values, at)).abs() <= band;
        let first = (0..at).rev().take_while(near).last().unwrap_or(at);
        let last = (at..values.len()).take_while(near).last().unwrap_or(at);
        Turn { at, plateau: [first, last] }
    };
    (found.iter().map(|at| within(*at)).collect(), least)
}

fn value(values: &[f64], at: usize) -> f64 {
    // Turning points lie within the series.
    values.get(at).copied().unwrap_or(f64::NAN)
}

/// Half swings between the turning points of a record, and what is usual among them.
struct HalfSwings<'a> {
    turns: &'a [Turn],
    /// Heights, in the record's unit.
    heights: Vec<f64>,
    /// Durations by the stamps, in seconds, and by the rows, from one plateau to the next.
    durations: [Vec<f64>; 2],
    /// Times of the samples by the stamps, in seconds, and their rows.
    times: [Vec<f64>; 2],
    /// Median durations of the large half swings.
    usual: [f64; 2],
    /// Height from which a half swing is large.
    large: f64,
    /// Smallest height of a half swing that is seen.
    least: f64,
}

impl<'a> HalfSwings<'a> {
    fn new(record: &Record, turns: &'a [Turn], least: f64) -> Self {
        let values = record.values();
        let times = [record.stamps_s().to_vec(), record.row_numbers()];
        let pairs = || turns.iter().zip(turns.iter().skip(1));
        let heights: Vec<f64> =
            pairs().map(|(one, next)| (value(values, next.at) - value(values, one.at)).abs()).collect();
        let large = (LARGE * heights.iter().copied().fold(0.0, f64::max)).max(2.0 * least);
        let middle =
            |turn: &Turn, times: &[f64]| 0.5 * turn.plateau.map(|at| value(times, at)).iter().sum::<f64>();
        let usual = times.each_ref().map(|times| {
            let between = pairs().map(|(one, next)| middle(next, times) - middle(one, times));
            let of_large = heights.iter().zip(between).filter(|(height, _)| **height > large);
            // Nothing is longer than usual if no half swing is large.
            upper_median(of_large.map(|(_, duration)| duration).collect()).unwrap_or(f64::INFINITY)
        });
        let durations = |times: &[f64], usual: f64| -> Vec<f64> {
            let ends = |turn: &Turn| {
                let [first, last] = turn.plateau.map(|at| value(times, at));
                let middle = middle(turn, times);
                // A half swing begins where something that was held is let go.
                if last - first > HELD * usual { (first, last) } else { (middle, middle) }
            };
            pairs().map(|(one, next)| ends(next).0 - ends(one).1).collect()
        };
        let [of_stamps, of_rows] = usual;
        let [stamps, rows] = &times;
        let durations = [durations(stamps, of_stamps), durations(rows, of_rows)];
        Self { turns, heights, durations, times, usual, large, least }
    }

    /// Returns the turning points, by their number, at which one piece of the record ends and another begins.
    fn breaks(&self) -> Vec<usize> {
        (1..self.turns.len()).filter(|number| self.is_break(*number)).collect()
    }

    fn is_break(&self, number: usize) -> bool {
        let height = |back: usize| number.checked_sub(back).and_then(|at| self.heights.get(at)).copied();
        let Some(before) = height(1) else { return false };
        let after = height(0).unwrap_or(0.0);
        if before.max(after) < self.large || self.has_gap(number) {
            return false;
        }
        let struck = after > STRUCK * before && after - before > self.large;
        let expected = height(2).map_or(before, |earlier| before - (earlier - before).max(0.0));
        let fall = before - expected;
        let seen = expected > (2.0 * self.least).max(3.0 * fall)
            && before > self.large
            && (number + 2 < self.turns.len() || self.goes_on());
        let stopped = number > 1 && seen && after < STOPPED * expected;
        // Where lines were dropped a half swing is short, but as high as its neighbors.
        let unlike = (after - before).abs() > UNLIKE * before.max(after);
        let uneven = unlike
            && before.min(after) > self.large
            // Clocks of hosts stand still and jump though the samples are even, and rows may be missing.
            && self.durations.iter().all(|durations| {
                let pair = number.checked_sub(1).and_then(|at| durations.get(at)).zip(durations.get(number));
                pair.is_some_and(|(one, next)| one.max(*next) > UNEVEN * one.min(*next))
            });
        struck || stopped || uneven || self.is_held(number)
    }

    /// Returns the free swing between two turning points, by their numbers, the second of which ends it; `None`
    /// if there is none.
    fn free(&self, from: usize, to: usize) -> Option<FreeSwing> {
        let is_last = to == self.turns.len();
        let last = if is_last { to.checked_sub(1)? } else { to };
        let heights = self.heights.get(from..last)?;
        let slowed = self.slowed(heights);
        let count = slowed.unwrap_or(heights.len());
        let pairs = || heights.iter().zip(heights.iter().skip(1)).take(count.saturating_sub(1));
        let rises = pairs().filter(|(one, next)| **next > 1.03 * **one + 0.25 * self.least).count();
        let rises_far = pairs().any(|(one, next)| next - one > 0.5 * self.large);
        let grows = heights.first() < count.checked_sub(1).and_then(|last| heights.get(last));
        if count < FEWEST || rises as f64 > RISES * count as f64 || rises_far || grows {
            return None;
        }
        let samples = self.times.first()?.len();
        let start = if from == 0 && !self.is_held(0) { 0 } else { self.turns.get(from)?.plateau[1] };
        let end = if is_last && slowed.is_none() { samples - 1 } else { self.turns.get(from + count)?.at };
        (end > start).then_some(FreeSwing { samples: [start, end], half_swings: count })
    }

    /// Returns what lies between two samples as a free swing; `None` if it hardly swings there.
    fn between(&self, [start, end]: [usize; 2]) -> Option<FreeSwing> {
        let inside = |turn: &Turn| (start..=end).contains(&turn.at);
        let within = self.turns.iter().zip(&self.heights).filter(|(turn, _)| inside(turn));
        let half_swings = within.filter(|(_, height)| **height > self.large).count();
        let swing = FreeSwing { samples: [start, end], half_swings };
        (half_swings >= FEWEST && swing.is_record()).then_some(swing)
    }

    /// Returns `true` if many large half swings follow the last of some free swings: what a hand has stopped
    /// moves again only if it is struck, and then swings freely.
    fn goes_on_after(&self, found: &[FreeSwing]) -> bool {
        let end = found.iter().map(|swing| swing.samples[1]).max();
        let after = self.turns.iter().zip(&self.heights).filter(|(turn, _)| Some(turn.at) >= end);
        after.filter(|(_, height)| **height > self.large).count() > 3
    }

    /// Returns the part of the motion outside some free swings, by its time, that large half swings of usual
    /// duration take.
    fn regular_outside(&self, found: &[FreeSwing]) -> f64 {
        let [durations, _] = &self.durations;
        let [usual, _] = self.usual;
        let ends = self.turns.iter().zip(self.turns.iter().skip(1)).map(|(one, next)| [one.at, next.at]);
        let outside = |[from, to]: [usize; 2]| {
            !found.iter().any(|swing| swing.samples[0] <= from.max(1) && to <= swing.samples[1])
        };
        let half_swings = ends.zip(durations).zip(&self.heights).filter(|((ends, _), _)| outside(*ends));
        let (mut all, mut regular, mut count) = (0.0, 0.0, 0);
        for ((_, duration), height) in half_swings {
            let is_usual = (duration - usual).abs() < 0.3 * usual && *height > 0.5 * self.large;
            all += duration;
            regular += if is_usual { *duration } else { 0.0 };
            count += usize::from(is_usual);
        }
        // A hand may take about as long as a half swing, but hardly four times.
        if count > 3 { regular / all } else { 0.0 }
    }

    /// Returns the number of half swings before a hand slows the swing: all later ones that are large fall far
    /// more than the median of those before.
    fn slowed(&self, heights: &[f64]) -> Option<usize> {
        let falls: Vec<f64> =
            heights.iter().zip(heights.iter().skip(1)).map(|(one, next)| one - next).collect();
        (FEWEST..=falls.len().checked_sub(1)?)
            .find(|number| {
                let (before, after) = falls.split_at(*number);
                let Some(median) = upper_median(before.to_vec()) else { return false };
                let beside = heights.get(*number).copied().unwrap_or(f64::INFINITY);
                let least = (SLOWED * median).max(0.05 * beside).max(0.5 * self.least);
                beside > self.large && after.iter().all(|fall| *fall > least)
            })
            .map(|number| number + 1)
    }

    /// Returns `true` if the first turning point is the beginning of the record, and not at rest or held there.
    fn begins_within(&self) -> bool {
        let at_start = self.turns.first().is_some_and(|turn| turn.plateau[0] == 0);
        at_start && !self.is_held(0)
    }

    fn is_held(&self, number: usize) -> bool {
        let Some([first, last]) = self.turns.get(number).map(|turn| turn.plateau) else { return false };
        let long = |(times, usual): (&Vec<f64>, f64)| value(times, last) - value(times, first) > HELD * usual;
        number + 1 < self.turns.len() && self.times.iter().zip(self.usual).all(long)
    }

    /// Returns `true` if the record lasts for two half swings after its last turning point.
    fn goes_on(&self) -> bool {
        let Some(last) = self.turns.last() else { return false };
        let rest = |times: &[f64]| times.last().map(|end| end - value(times, last.at));
        self.times
            .iter()
            .zip(self.usual)
            .all(|(times, usual)| rest(times).is_some_and(|rest| rest > 2.0 * usual))
    }

    /// Returns `true` if samples are missing for a quarter of a half swing beside a turning point.
    fn has_gap(&self, number: usize) -> bool {
        let turn = |number: usize| self.turns.get(number).map(|turn| turn.at);
        let from = number.checked_sub(2).and_then(turn).unwrap_or(0);
        let to = turn(number + 1).unwrap_or(usize::MAX);
        self.times.iter().zip(self.usual).any(|(times, usual)| {
            // A gap that begins at the last of them takes the turning point that would have followed.
            let part = times.get(from..=to.saturating_add(1).min(times.len() - 1)).unwrap_or(times);
            part.windows(2).any(|pair| matches!(pair, [one, next] if next - one > GAP * usual))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::free_swings;
    use crate::record::{Quantity, Record};
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const RATE: f64 = 100.0;

    fn record(duration_s: f64, noise: f64, motion: impl Fn(f64) -> f64) -> Record {
        let mut draws = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        let times: Vec<f64> = (0..(duration_s * RATE) as usize).map(|at| at as f64 / RATE).collect();
        let mut value = |time: &f64| {
            let draw: f64 = StandardNormal.sample(&mut draws);
            motion(*time) + noise * draw
        };
        let values = times.iter().map(&mut value).collect();
        Record::new(times, values, None, Quantity::Position, "rad").unwrap()
    }

    fn decay(time: f64) -> f64 {
        (-0.1 * time).exp() * (6.0 * time).cos()
    }

    fn parts(record: &Record) -> Vec<[f64; 2]> {
        let swings = free_swings(record);
        swings.iter().map(|swing| swing.samples.map(|at| record.stamps_s()[at])).collect()
    }

    #[test]
    fn a_lift_a_hold_and_a_stop_are_left_out() {
        for noise in [1e-4, 0.02] {
            let lifted = record(24.0, noise, |time| match time {
                time if time < 2.0 => 0.0,
                time if time < 3.5 => 0.5 - 0.5 * (std::f64::consts::PI * (time - 2.0) / 1.5).cos(),
                time if time < 5.0 => 1.0,
                time => decay(time - 5.0),
            });
            let found = parts(&lifted);
            assert!(found.len() == 1 && (found[0][0] - 5.0).abs() < 0.15 && found[0][1] > 23.9, "{found:?}");
            let stopped = record(24.0, noise, |time| if time < 12.0 { decay(time) } else { 0.0 });
            let found = parts(&stopped);
            assert!(found.len() == 1 && found[0][0] == 0.0 && (found[0][1] - 12.0).abs() < 0.7, "{found:?}");
            let again =
                record(24.0, noise, |time| if time < 12.0 { decay(time) } else { 1.4 * decay(time - 12.0) });
            let found = parts(&again);
            assert!(found.len() == 2 && (found[1][0] - 12.0).abs() < 0.7, "{found:?}");
        }
    }

    /// Regression: each wrong value was a strike and a stop, and the longest part between two of them was read.
    #[test]
    fn wrong_values_are_no_strikes() {
        // One value in forty, in no order.
        let wrong = |time: f64| (time * RATE).round() as u64 * 7_919 % 6_007 % 1_000 < 25;
        let found = parts(&record(30.0, 0.005, |time| decay(time) + if wrong(time) { 0.8 } else { 0.0 }));
        assert!(found.is_empty(), "{found:?}");
    }

    /// Regression: a hold that is longer than the swing counted as motion, and the swing was read with the lift.
    #[test]
    fn a_long_hold_is_no_motion() {
        let held = record(30.0, 0.01, |time| match time {
            time if time < 2.0 => 0.0,
            time if time < 5.0 => 0.5 - 0.5 * (std::f64::consts::PI * (time - 2.0) / 3.0).cos(),
            time if time < 20.0 => 1.0,
            time => decay(time - 20.0),
        });
        let found = parts(&held);
        assert!(found.len() == 1 && (found[0][0] - 20.0).abs() < 0.15 && found[0][1] > 29.9, "{found:?}");
    }

    /// Regression: more than three strikes made more breaks than a hand, and the swings were read as one.
    #[test]
    fn every_strike_begins_a_free_swing() {
        let struck =
            record(60.0, 1e-4, |time| (time % 12.0 / 3.0).exp().recip() * (6.0 * (time % 12.0)).sin());
        let found = parts(&struck);
        assert_eq!(found.len(), 5, "{found:?}");
        for (number, [from, _]) in found.iter().enumerate() {
            let strike = 12.0 * number as f64;
            assert!((strike - 0.1..strike + 0.7).contains(from), "{found:?}");
        }
    }

    /// A step and a release of a well-damped system after a rest; from its first sample on, a slow return is whole.
    #[test]
    fn a_motion_of_few_half_swings_begins_after_the_rest() {
        let returned = |time: f64| (-2.0 * time).exp() * ((5.0 * time).cos() + 0.4 * (5.0 * time).sin());
        for held in [0.0, 1.0] {
            let motion = |time: f64| if time < 3.0 { held } else { held - 1.0 + returned(time - 3.0) };
            let found = parts(&record(12.0, 1e-3, motion));
            assert!(found.len() == 1 && (found[0][0] - 3.0).abs() < 0.1 && found[0][1] > 11.9, "{found:?}");
        }
        let slow = |time: f64| (1.0 + 2.0 * time) * (-2.0 * time).exp();
        assert!(parts(&record(12.0, 0.01, slow)).is_empty());
    }

    /// Beating, growth, dry friction, a shift of the rest position and a swing over many decades are free.
    #[test]
    fn a_free_swing_is_left_whole() {
        let dry = |time: f64| (1.0 - 0.06 * time).max(0.0) * (6.0 * time).cos();
        let second = |time: f64| 0.5 * (-0.16 * time).exp() * (18.5 * time).cos();
        let motions: [&dyn Fn(f64) -> f64; 7] = [
            &|time| decay(time) + second(time),
            &decay,
            &|time| (-0.01 * time).exp() * ((6.0 * time).cos() + 0.9 * (6.4 * time).cos()),
            &|time| 0.1 * (0.08 * time).exp() * (6.0 * time).sin(),
            &dry,
            &|time| decay(time) + 0.05 * time,
            &|time| (-0.6 * time).exp() * (6.0 * time).cos(),
        ];
        for (number, motion) in motions.iter().enumerate() {
            for noise in [1e-5, 0.01, 0.05] {
                let found = parts(&record(30.0, noise, motion));
                assert!(found.is_empty(), "{number} {noise}: {found:?}");
            }
        }
    }
}
