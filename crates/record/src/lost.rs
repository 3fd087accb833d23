//! The index that samples would have if none had been lost.

use crate::line::{Bend, Line};
use crate::roughness::off_cubic;

/// Samples numbered by the sensor's own clock, lost ones included.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Numbers {
    /// Number of each sample, from 0.
    pub(crate) of_samples: Vec<f64>,
    /// The last sample of each group of equal stamps: number and stamp.
    pub(crate) ends: Vec<(f64, f64)>,
    /// Samples that are missing.
    pub(crate) lost: usize,
}

/// Part of a phase error by which the tracked phase of the even clock moves, pass by pass: each pass sharpens the interval that
/// the next counts with, and less has to be made up for by following.
const GAINS: [f64; 5] = [0.3, 0.2, 0.1, 0.05, 0.05];

/// Groups in a stretch that a first interval is taken from.
const STRETCH: usize = 16;

/// Groups ahead that have to share a shift before samples count as lost: a late group is late alone.
const LASTING: usize = 4;

/// Part of an interval that stamps may scatter by, root mean square, for their steps to be counted: a step then scatters by
/// 0.21 intervals, and one of 120 is miscounted.
const SCATTER: f64 = 0.15;

/// Factor by which counting has to bring groups nearer to an even clock where it does not bring all within that range: where a
/// burst lost samples in several places, it still comes out far better than no count.
const NEARER: f64 = 5.0;

/// Range of the distances of groups' ends from an even clock, in intervals: the last sample of a group waits for up to one.
const LATENESS: f64 = 1.2;

impl Numbers {
    /// Every sample counted, none lost.
    pub(crate) fn plain(ends: &[(f64, f64)], samples: usize) -> Self {
        Self { of_samples: (0..samples).map(|index| index as f64).collect(), ends: ends.to_vec(), lost: 0 }
    }

    /// Counts lost samples from the stamps at the ends of groups; `None` where the stamps speak against any, or cannot tell.
    ///
    /// The phase of an even clock is tracked from group to group. Where a group and the next ones all lie later than it by
    /// whole intervals, so many samples are missing. The count stands if every group then lies as near to an even clock (which
    /// may drift) as groups without a loss do, and if that improves by more than the information criterion's price of two numbers,
    /// place and length, for each gap. Where in its group a gap lies, the values tell: they run most smoothly.
    pub(crate) fn with_lost(
        ends: &[(f64, f64)],
        values: &[f64],
        stamps: &[f64],
        rounding: f64,
    ) -> Option<Self> {
        let sizes: Vec<f64> =
            ends.iter().zip(ends.iter().skip(1)).map(|(one, next)| next.0 - one.0).collect();
        let grouped = ends.len() < values.len();
        // A record may end within a group, whose last sample is not there.
        let whole = ends.len() - usize::from(grouped);
        let lines = |ends: &[(f64, f64)]| {
            let ends = ends.get(..whole).unwrap_or_default();
            Bend::of(&Line::through(ends), ends)
        };
        let before = lines(ends);
        let mut best: Option<(f64, Vec<(f64, f64)>, Bend)> = None;
        for mut interval in intervals(ends.get(..whole)?) {
            let mut counted = Vec::new();
            for gain in GAINS {
                counted = count(ends, &sizes, interval, gain, whole);
                interval = Line::through(counted.get(..whole)?).slope;
            }
            let after = lines(&counted);
            let squares = after.line.squares() / (interval * interval);
            if best.as_ref().is_none_or(|best| squares < best.0) {
                best = Some((squares, counted, after));
            }
        }
        let (_, counted, after) = best?;
        let interval = after.line.slope;
        let number = |at: usize| counted.get(at).map_or(0.0, |end| end.0);
        let gaps: Vec<usize> = (1..counted.len())
            .filter(|&at| number(at) - number(at - 1) > sizes.get(at - 1).copied().unwrap_or(1.0) + 0.5)
            .collect();
        let last = (counted.last()?.0 - ends.last()?.0).round();
        if gaps.is_empty() || last < 1.0 {
            return None;
        }
        let count = whole as f64;
        let gain = count * (before.line.squares() / after.line.squares().max(f64::MIN_POSITIVE)).ln();
        let waits = |bend: &Bend| range(&bend.line.residuals) <= LATENESS * interval + 2.0 * rounding;
        let near = if grouped {
            let nearer = NEARER * range(&after.line.residuals) <= range(&before.line.residuals);
            !waits(&before) && (waits(&after) || nearer)
        } else {
            (after.line.squares() / count).sqrt() <= SCATTER * interval + rounding
        };
        if !near || gain <= 2.0 * count.ln() * gaps.len() as f64 {
            return None;
        }
        let of_samples = place(ends, &counted, values, stamps.len());
        Some(Self { of_samples, ends: counted, lost: last as usize })
    }
}

/// Largest less smallest.
fn range(series: &[f64]) -> f64 {
    let highest = series.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    highest - series.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Intervals to begin with: over stretches of groups in which less was lost, and more.
fn intervals(ends: &[(f64, f64)]) -> Vec<f64> {
    let stretch = STRETCH.min(ends.len().saturating_sub(1)).max(1);
    let pairs = ends.iter().zip(ends.iter().skip(stretch));
    let mut rates: Vec<f64> = pairs.map(|(one, next)| (next.1 - one.1) / (next.0 - one.0)).collect();
    rates.sort_by(f64::total_cmp);
    let at = |part: usize| rates.get(rates.len() * part / 20).copied();
    (0..=10).filter_map(at).filter(|interval| *interval > 0.0).collect()
}

/// Numbers of the groups' ends for a known interval.
fn count(ends: &[(f64, f64)], sizes: &[f64], interval: f64, gain: f64, whole: usize) -> Vec<(f64, f64)> {
    let Some(&(first, start)) = ends.first() else { return Vec::new() };
    let mut counted = vec![(first, start)];
    // The stamp of number 0 on the tracked clock.
    let mut phase = start - interval * first;
    let mut lost = 0.0;
    for (at, (end, size)) in ends.iter().skip(1).zip(sizes).enumerate() {
        let late = |end: &(f64, f64)| (end.1 - phase) / interval - end.0 - lost;
        let lasting = ends.iter().skip(at + 1).take(LASTING).map(late).fold(f64::INFINITY, f64::min);
        // A count that was one too many is taken back, as far as numbers still grow.
        let more = lasting.round().max(1.0 - size).max(-lost);
        let settled = (lasting < 0.0 && late(end) > -0.5 * LATENESS) || at + 1 >= whole;
        let more = if settled { 0.0 } else { more };
        lost += more;
        let error = end.1 - phase - interval * (end.0 + lost);
        phase += error * gain.max(1.0 / (at as f64 + 2.0));
        counted.push((end.0 + lost, end.1));
    }
    counted
}

/// Numbers of all samples: within a group with a loss, the gap lies where the values then run most smoothly.
fn place(ends: &[(f64, f64)], counted: &[(f64, f64)], values: &[f64], samples: usize) -> Vec<f64> {
    let mut numbers: Vec<f64> = Vec::with_capacity(samples);
    let mut before = (-1.0, -1.0);
    for (end, number) in ends.iter().zip(counted) {
        let size = (end.0 - before.0) as usize;
        let lost = number.0 - before.1 - size as f64;
        let numbered = |early: usize| {
            (0..size).map(move |at| before.1 + 1.0 + at as f64 + if at < early { 0.0 } else { lost })
        };
        let mut early = 0;
        if lost > 0.5 && size > 1 {
            let from = numbers.len().saturating_sub(4);
            let past: Vec<f64> = numbers.get(from..).unwrap_or_default().to_vec();
            let to = (numbers.len() + size + 4).min(values.len());
            let seen = values.get(from..to).unwrap_or_default();
            let roughness = |early: usize| {
                let next = (1..=4).map(|at| number.0 + f64::from(at));
                let times: Vec<f64> = past.iter().copied().chain(numbered(early)).chain(next).collect();
                times.windows(5).zip(seen.windows(5)).map(|(t, y)| off_cubic(t, y).powi(2)).sum::<f64>()
            };
            early = (0..=size)
                .map(|early| (early, roughness(early)))
                .min_by(|one, other| one.1.total_cmp(&other.1))
                .map_or(0, |best| best.0);
            if early == size {
                early = 0;
            }
        }
        numbers.extend(numbered(early));
        before = (end.0, number.0);
    }
    numbers
}
