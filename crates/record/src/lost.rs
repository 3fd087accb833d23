//! Sample index with lost samples counted.

#![allow(
    clippy::indexing_slicing,
    reason = "there is a number for the end of every group, and a value for every row"
)]

use crate::line::{Bend, Line};
use crate::roughness::off_cubic;
use crate::statistics::extremes;

/// Number and stamp of the last sample of each group of equal stamps.
type Ends = Vec<(f64, f64)>;

/// Numbers of the samples by the sensor's own clock, with lost samples counted.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Numbers {
    /// Number of each sample, from 0.
    pub(crate) of_samples: Vec<f64>,
    /// Last sample of each group.
    pub(crate) ends: Ends,
    /// Number of lost samples.
    pub(crate) lost: usize,
}

/// Share of the phase error by which the tracked phase of the even clock is corrected, pass by pass. Each
/// pass sharpens the interval for the next count, so less has to be corrected by tracking.
const GAINS: [f64; 5] = [0.3, 0.2, 0.1, 0.05, 0.05];

/// Number of groups in a stretch from which a first interval is computed.
const STRETCH: usize = 16;

/// Number of successive groups that have to share a shift before samples count as lost; a single late group
/// is only late.
const LASTING: usize = 4;

/// Largest number of corrections of the count.
const MOST_MENDED: usize = 500;

/// Largest root mean square scatter of stamps, in intervals, at which their steps can be counted: a step then
/// scatters by 0.21 intervals, and one of 120 is miscounted.
const SCATTER: f64 = 0.15;

/// Factor by which counting has to reduce the groups' range of distances from an even clock if it does not
/// bring that range below [`LATENESS`]. After a burst that lost samples in several places, the count still
/// fits far better than none.
const NEARER: f64 = 3.0;

/// Range of the distances of groups' ends from an even clock, in intervals: the last sample of a group waits
/// for up to one interval.
const LATENESS: f64 = 1.2;

/// Deviation of every step from the mean one, as a part of it, below which no sample is missing.
const ALIKE: f64 = 0.3;

impl Numbers {
    /// Numbers the samples by rows, with no losses.
    pub(crate) fn plain(ends: &[(f64, f64)], rows: &[f64]) -> Self {
        Self { of_samples: rows.to_vec(), ends: ends.to_vec(), lost: 0 }
    }

    /// Counts lost samples from the stamps at the ends of groups; returns `None` if the stamps contradict a
    /// loss or cannot show one.
    ///
    /// The phase of an even clock is tracked from group to group. If a group and the next ones all lie later
    /// than this clock by whole intervals, that many samples are missing. The count is accepted if every
    /// group then lies as near to an even clock (which may drift) as groups without a loss do, and if the fit
    /// improves by more than the information criterion's price of two numbers, place and length, for each
    /// gap. The place of a gap within its group is the one where the values run most smoothly. `rows` numbers
    /// the samples among the rows of their file: rows without a value are not lost.
    /// file: rows without a value are not lost.
    pub(crate) fn with_lost(
        ends: &[(f64, f64)],
        rows: &[f64],
        values: &[f64],
        rounding: f64,
    ) -> Option<Self> {
        let sizes: Vec<f64> =
            ends.iter().zip(ends.iter().skip(1)).map(|(one, next)| next.0 - one.0).collect();
        let grouped = ends.len() < values.len();
        if !grouped && are_alike(ends, &sizes) {
            return None;
        }
        // A record may end within a group, whose last sample is then missing.
        let whole = ends.len() - usize::from(grouped);
        let before = bend(ends, whole);
        let (counted, after) = best_count(ends, &sizes, whole)?;
        let interval = after.line.slope;
        let number = |at: usize| counted[at].0;
        let gaps: Vec<usize> = (1..counted.len())
            .filter(|&at| number(at) - number(at - 1) > sizes.get(at - 1).copied().unwrap_or(1.0) + 0.5)
            .collect();
        let last = (counted.last()?.0 - ends.last()?.0).round();
        if gaps.is_empty() || last < 1.0 {
            return None;
        }
        let count = whole as f64;
        let gain = count * libm::log(before.line.squares() / after.line.squares().max(f64::MIN_POSITIVE));
        let waits = |bend: &Bend| range(&bend.line.residuals) <= LATENESS * interval + 2.0 * rounding;
        let near = if grouped {
            let nearer = NEARER * range(&after.line.residuals) <= range(&before.line.residuals);
            !waits(&before) && (waits(&after) || nearer)
        } else {
            (after.line.squares() / count).sqrt() <= SCATTER * interval + rounding
        };
        if !near || gain <= 2.0 * libm::log(count) * gaps.len() as f64 {
            return None;
        }
        let of_samples = place(ends, &counted, rows, values);
        Some(Self { of_samples, ends: counted, lost: last as usize })
    }
}

/// Returns `true` if the times between single samples are so much alike that none is missing.
fn are_alike(ends: &[(f64, f64)], sizes: &[f64]) -> bool {
    let steps = || ends.iter().zip(ends.iter().skip(1)).map(|(one, next)| next.1 - one.1);
    let mean = steps().sum::<f64>() / sizes.iter().sum::<f64>();
    steps().zip(sizes).all(|(step, size)| (step / (mean * size) - 1.0).abs() < ALIKE)
}

/// Fits a line with a bend to the complete groups.
fn bend(ends: &[(f64, f64)], whole: usize) -> Bend {
    let ends = &ends[..whole];
    Bend::of(&Line::through(ends), ends)
}

/// Returns the count of samples that lies nearest to an even clock which may drift, with that clock. Several
/// first guesses of the interval are tried.
fn best_count(ends: &[(f64, f64)], sizes: &[f64], whole: usize) -> Option<(Ends, Bend)> {
    let mut best: Option<(f64, Ends, Bend)> = None;
    let starts = intervals(ends.get(..whole)?);
    for (mut interval, takes_back) in starts.iter().flat_map(|start| [(*start, true), (*start, false)]) {
        let mut counted = Vec::new();
        for gain in GAINS {
            counted = count(ends, interval, gain, takes_back, whole);
            interval = Line::through(counted.get(..whole)?).slope;
        }
        for _ in 0..MOST_MENDED {
            shift(&mut counted, sizes, whole);
            if !mend(&mut counted, sizes, whole) {
                break;
            }
        }
        let after = bend(&counted, whole);
        let squares = after.line.squares() / after.line.slope.powi(2);
        if best.as_ref().is_none_or(|best| squares < best.0) {
            best = Some((squares, counted, after));
        }
    }
    best.map(|(_, counted, after)| (counted, after))
}

/// Moves lost samples between neighboring groups. If a burst lost its last samples, its last remaining sample
/// waited for longer than an interval, and the loss seems to belong to the next burst.
fn shift(counted: &mut Ends, sizes: &[f64], whole: usize) {
    let Some(ends) = counted.get(..whole) else { return };
    let line = Line::through(ends);
    let late: Vec<f64> = line.residuals.iter().map(|residual| residual / line.slope).collect();
    for (at, late) in late.iter().enumerate().take(whole.saturating_sub(1)).skip(1) {
        let number = |at: usize| counted[at].0;
        let lost = |at: usize| number(at) - number(at - 1) - sizes.get(at - 1).copied().unwrap_or(1.0);
        let more =
            if late.abs() > 0.5 * LATENESS { late.round().min(lost(at + 1)).max(-lost(at)) } else { 0.0 };
        if let Some(end) = counted.get_mut(at) {
            end.0 += more;
        }
    }
}

/// Adds or removes one sample from one group on, at the group where this brings all groups nearest to an even
/// clock that may drift; returns `true` if there is such a group. A tracked count can miss a single sample,
/// which shifts all that follows.
///
/// A step of one interval Δ at group k changes the sum of squares by −2Δ·Σᵢ≥ₖ rᵢ + Δ²·‖Pk‖², where Pk is the
/// step after constants, the line and the parabola are projected out. The sum has to fall by more than 2·ln N
/// times Δ²/12, the variance of the waiting time of a group's last sample.
fn mend(counted: &mut Ends, sizes: &[f64], whole: usize) -> bool {
    let Some(ends) = counted.get(..whole) else { return false };
    let line = Line::through(ends);
    let residuals = Bend::of(&line, ends).line.residuals;
    let interval = line.slope;
    let mean = ends.iter().map(|end| end.0).sum::<f64>() / whole as f64;
    let linear: Vec<f64> = ends.iter().map(|end| (end.0 - mean) / line.spread_x.sqrt()).collect();
    let squares: Vec<(f64, f64)> = ends.iter().map(|end| (end.0, (end.0 - mean).powi(2))).collect();
    let bent = Line::through(&squares).residuals;
    let length = bent.iter().map(|b| b * b).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
    let constant = 1.0 / (whole as f64).sqrt();
    let mut sums = [0.0; 4];
    let mut best = (-2.0 * libm::log(whole as f64) / 12.0, 0, 0.0);
    for at in (1..whole).rev() {
        let terms = [residuals[at] / interval, constant, linear[at], bent[at] / length];
        for (sum, term) in sums.iter_mut().zip(terms) {
            *sum += term;
        }
        let [residual, level, slope, curve] = sums;
        let step = (whole - at) as f64 - level * level - slope * slope - curve * curve;
        let lost = ends[at].0 - ends[at - 1].0 - sizes.get(at - 1).copied().unwrap_or(1.0);
        for more in [1.0, -1.0] {
            let change = step - 2.0 * more * residual;
            if change < best.0 && lost + more > -0.5 {
                best = (change, at, more);
            }
        }
    }
    let (_, from, more) = best;
    if more != 0.0 {
        for end in counted.iter_mut().skip(from) {
            end.0 += more;
        }
    }
    more != 0.0
}

/// Returns the largest minus the smallest value.
fn range(series: &[f64]) -> f64 {
    let [lowest, highest] = extremes(series);
    highest - lowest
}

/// Returns first guesses of the interval, from stretches of groups with few to many losses.
fn intervals(ends: &[(f64, f64)]) -> Vec<f64> {
    let stretch = STRETCH.min(ends.len().saturating_sub(1)).max(1);
    let pairs = ends.iter().zip(ends.iter().skip(stretch));
    let mut rates: Vec<f64> = pairs.map(|(one, next)| (next.1 - one.1) / (next.0 - one.0)).collect();
    rates.sort_by(f64::total_cmp);
    let at = |part: usize| rates.get(rates.len() * part / 20).copied();
    (0..=10).filter_map(at).filter(|interval| *interval > 0.0).collect()
}

/// Numbers the groups' ends for a known interval. A count that can be taken back (`takes_back`) is more
/// reliable if few samples are lost, one that cannot if many are.
fn count(ends: &[(f64, f64)], interval: f64, gain: f64, takes_back: bool, whole: usize) -> Ends {
    let Some(&(first, start)) = ends.first() else { return Vec::new() };
    let mut counted = vec![(first, start)];
    // Stamp of number 0 on the tracked clock.
    let mut phase = start - interval * first;
    let mut lost = 0.0;
    for (at, end) in ends.iter().skip(1).enumerate() {
        let late = |end: &(f64, f64)| (end.1 - phase) / interval - end.0 - lost;
        let lasting = ends.iter().skip(at + 1).take(LASTING).map(late).fold(f64::INFINITY, f64::min);
        // The last group may be cut off. A count that was too high is taken back.
        let settled = (lasting < 0.0 && late(end) > -0.5 * LATENESS) || at + 1 >= whole;
        lost += if settled { 0.0 } else { lasting.round().max(if takes_back { -lost } else { 0.0 }) };
        let error = end.1 - phase - interval * (end.0 + lost);
        phase += error * gain.max(1.0 / (at as f64 + 2.0));
        counted.push((end.0 + lost, end.1));
    }
    // Samples whose count was taken back were not lost earlier either.
    let mut lost = f64::INFINITY;
    for (number, end) in counted.iter_mut().zip(ends).rev() {
        lost = lost.min(number.0 - end.0);
        number.0 = end.0 + lost;
    }
    counted
}

/// Numbers all samples. Within a group with a loss, the gap is placed where the values then run most
/// smoothly.
fn place(ends: &[(f64, f64)], counted: &[(f64, f64)], rows: &[f64], values: &[f64]) -> Vec<f64> {
    let mut numbers: Vec<f64> = Vec::with_capacity(rows.len());
    let mut lost_before = 0.0;
    for (end, number) in ends.iter().zip(counted) {
        // Samples of the group and those that follow it.
        let left = &rows[numbers.len()..];
        let (group, following) = left.split_at(left.partition_point(|row| *row <= end.0));
        let lost_here = number.0 - end.0;
        let numbered = |early: usize| {
            let of = move |at| if at < early { lost_before } else { lost_here };
            group.iter().enumerate().map(move |(at, row)| row + of(at))
        };
        let mut early = 0;
        if lost_here - lost_before > 0.5 && group.len() > 1 {
            let from = numbers.len().saturating_sub(4);
            let past: Vec<f64> = numbers.iter().skip(from).copied().collect();
            let to = (numbers.len() + group.len() + 4).min(values.len());
            let seen = &values[from..to];
            let roughness = |early: usize| {
                let next = following.iter().take(4).map(|row| row + lost_here);
                let times: Vec<f64> = past.iter().copied().chain(numbered(early)).chain(next).collect();
                times.windows(5).zip(seen.windows(5)).map(|(t, y)| off_cubic(t, y).powi(2)).sum::<f64>()
            };
            let mut least = roughness(0);
            for candidate in 1..=group.len() {
                let next = roughness(candidate);
                if next.total_cmp(&least).is_lt() {
                    (early, least) = (candidate, next);
                }
            }
        }
        numbers.extend(numbered(early));
        lost_before = lost_here;
    }
    numbers
}

#[cfg(test)]
mod tests {
    use crate::{Clock, ClockChoice, ClockKind, Quantity, Record};

    const INTERVAL: f64 = 1.0 / 260.0;

    /// Returns pseudo-random numbers in 0..1 without a generator.
    fn uniform(index: usize) -> f64 {
        ((index as f64 + 1.0) * 12.9898).sin().mul_add(43_758.545_3, 0.0).rem_euclid(1.0)
    }

    fn rounded(time: f64) -> f64 {
        (time * 1e6).round() / 1e6
    }

    fn swing(time: f64) -> f64 {
        (-0.1 * time).exp() * (20.0 * time).sin()
    }

    /// Returns the clock of samples of a swing with a little noise, with the given numbers, each stamped by
    /// `stamp`.
    fn clock(numbers: &[usize], stamp: impl Fn(usize) -> f64, choice: ClockChoice) -> Clock {
        let stamps = numbers.iter().map(|number| rounded(stamp(*number))).collect();
        let values = numbers.iter().map(|number| {
            swing(*number as f64 * INTERVAL) + 1e-3 * (uniform(9 * number) + uniform(9 * number + 1) - 1.0)
        });
        let record = Record::new(stamps, values.collect(), None, Quantity::Position, "rad").unwrap();
        Clock::new(&record, choice).unwrap()
    }

    /// Returns the numbers of the samples that remain if one stretch of one to `longest` samples is lost in
    /// every `every`.
    fn surviving(every: usize, longest: usize) -> Vec<usize> {
        let lost = |number: usize| {
            let (gap, place) = (number / every, number % every);
            let start = 20 + (uniform(gap) * (every - 40) as f64) as usize;
            let length = 1 + (uniform(gap + 1000) * longest as f64) as usize;
            (start..start + length).contains(&place)
        };
        (0..6500).filter(|number| !lost(*number)).collect()
    }

    /// Returns the stamp of a sample in bursts at about equal intervals: the time of the first burst after
    /// it.
    fn burst(number: usize, interval: f64, scatter: f64) -> f64 {
        let time = number as f64 * INTERVAL;
        let end = |at: usize| (at as f64 + 0.3 + scatter * (uniform(at) - 0.5)) * interval;
        let near = (time / interval) as usize;
        (near.saturating_sub(1)..near + 3).map(end).find(|end| *end >= time).unwrap()
    }

    /// Returns the errors of a clock's times, up to a constant.
    fn error(clock: &Clock, numbers: &[usize]) -> Vec<f64> {
        let off: Vec<f64> = clock
            .times_s
            .iter()
            .zip(numbers)
            .map(|(time, number)| time / INTERVAL - *number as f64)
            .collect();
        let mut ordered = off.clone();
        ordered.sort_by(f64::total_cmp);
        let middle = ordered[ordered.len() / 2];
        off.iter().map(|off| (off - middle).abs()).collect()
    }

    #[test]
    fn bursts_tell_lost_samples() {
        for (interval, scatter) in [(0.02, 0.2), (0.0616, 0.1)] {
            let numbers = surviving(400, 6);
            let clock = clock(&numbers, |number| burst(number, interval, scatter), ClockChoice::Auto);
            assert_eq!(clock.kind, ClockKind::IndexWithGaps, "{interval}: {}", clock.reason);
            let lost = 6500 - numbers.len();
            assert!(
                clock.statistics.lost.abs_diff(lost) <= 1,
                "{interval}: {} of {lost}",
                clock.statistics.lost
            );
            assert!((clock.sample_rate_hz * INTERVAL - 1.0).abs() < 1e-4, "{}", clock.sample_rate_hz);
            let wrong = error(&clock, &numbers).iter().filter(|error| **error > 0.6).count();
            assert!(wrong * 50 < numbers.len(), "{interval}: {wrong} samples are out of place");
        }
    }

    #[test]
    fn bursts_without_a_loss_lose_nothing() {
        let numbers: Vec<usize> = (0..6500).collect();
        for at in 0..300 {
            let (interval, scatter) = (0.01 + 0.07 * uniform(at + 50), 0.4 * uniform(at + 500));
            let clock = clock(&numbers[at..], |number| burst(number, interval, scatter), ClockChoice::Auto);
            assert_eq!(clock.statistics.lost, 0, "{interval} {scatter}: {}", clock.reason);
            assert_eq!(clock.kind, ClockKind::UniformIndex);
        }
    }

    /// Between the gaps, the index is the better clock for stamps whose scatter the values do not share.
    #[test]
    fn gaps_are_counted_through_jitter() {
        let numbers = surviving(100, 8);
        for scatter in [0.1, 0.3] {
            let stamp =
                |number: usize| (number as f64 + 1.0 + scatter * (uniform(7 * number) - 0.5)) * INTERVAL;
            let clock = clock(&numbers, stamp, ClockChoice::Auto);
            assert_eq!(clock.kind, ClockKind::IndexWithGaps, "{scatter}: {}", clock.reason);
            assert_eq!(clock.statistics.lost, numbers[numbers.len() - 1] + 1 - numbers.len(), "{scatter}");
            assert!(error(&clock, &numbers).iter().all(|error| *error < 0.1), "{scatter}");
        }
    }

    #[test]
    fn exact_stamps_with_gaps_stand() {
        let numbers = surviving(100, 8);
        let clock = clock(&numbers, |number| number as f64 * INTERVAL, ClockChoice::Auto);
        assert_eq!(clock.kind, ClockKind::Host, "{}", clock.reason);
        assert_eq!(clock.statistics.lost, numbers[numbers.len() - 1] + 1 - numbers.len());
        assert!((clock.sample_rate_hz * INTERVAL - 1.0).abs() < 1e-6, "{}", clock.sample_rate_hz);
    }

    /// The number of lost samples does not depend on the clock that a configuration sets.
    #[test]
    fn a_set_clock_knows_of_lost_samples() {
        let numbers = surviving(400, 6);
        for choice in [ClockChoice::Host, ClockChoice::UniformIndex] {
            let clock = clock(&numbers, |number| burst(number, 0.0616, 0.1), choice);
            assert!(clock.statistics.lost.abs_diff(6500 - numbers.len()) <= 1);
        }
    }
}
