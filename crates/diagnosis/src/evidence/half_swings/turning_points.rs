//! Turning points of a free swing, each from a local fit, tracked from one to the next.
//!
//! The local half period is updated from turn to turn, so that the tracking follows a frequency that changes
//! with the amplitude. Only the first turn needs a given frequency; it is searched for within a factor of
//! [`HINT`] of the expected one.

use crate::data::observations::Observations;
use crate::noise::statistics::median;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{PI, TAU};

/// Turning point of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Turn {
    pub(crate) time_s: f64,
    pub(crate) value: f64,
    /// Variances of value and time, from the scatter of the samples about the local fits.
    pub(crate) value_variance: f64,
    pub(crate) time_variance: f64,
}

/// Largest factor between the expected frequency and that of the first swings.
const HINT: f64 = 2.2;
/// Number of frequencies tried for the first swings.
const FREQUENCIES: usize = 32;
/// Length of the stretch in which the first turn is searched for, in expected periods.
const STRETCH: f64 = 3.0;
/// Largest number of stretches searched.
const MOST_STRETCHES: usize = 40;
/// Largest number of samples used of a stretch.
const MOST_SAMPLES: usize = 256;
/// Half the width of the stretch fitted around a turning point, in periods.
const HALF_WIDTH: f64 = 0.2;
/// Largest distance of a turning point from its expected time, in half periods.
const FARTHEST: f64 = 0.3;
/// Longest gap between samples in a half swing, in half periods.
const LONGEST_GAP: f64 = 0.35;
/// Number of consecutive missed turns at which the motion counts as ended.
const MOST_MISSED: usize = 4;
/// Number of standard errors by which an amplitude has to exceed zero.
const SMALLEST: f64 = 4.0;
/// Weight of the newest half period in the running estimate.
const NEWEST: f64 = 0.4;
/// Fewest samples for the five-term fit.
const FEWEST_FULL: usize = 9;
/// Tukey's constant for 95 % efficiency.
const TUKEY: f64 = 4.685;

/// Times and values of the samples used, and the standard deviation of the rounding error.
struct Samples {
    times: Vec<f64>,
    values: Vec<f64>,
    rounding: f64,
}

impl Samples {
    fn between(&self, from: f64, to: f64) -> std::ops::Range<usize> {
        let at = |limit: f64| self.times.partition_point(|&time| time < limit);
        at(from)..at(to)
    }

    fn points(&self, from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let range = self.between(from, to);
        let samples = self.times.iter().copied().zip(self.values.iter().copied());
        samples.skip(range.start).take(range.len())
    }

    /// Returns the longest time without a sample between two times.
    fn gap(&self, from: f64, to: f64) -> f64 {
        let inside = self.points(from, to).map(|point| point.0).chain([to]);
        inside.fold((from, 0.0_f64), |(last, gap), time| (time, gap.max(time - last))).1
    }
}

/// Returns the runs of successive turning points of a record, alternating between maxima and minima. No half
/// swing in a run has a gap. Empty if no swing stands out.
///
/// `angular_frequency` in rad/s is only a hint.
pub(crate) fn turning_points(record: &Observations, kept: &[bool], angular_frequency: f64) -> Vec<Vec<Turn>> {
    let pairs = record.times_s.iter().zip(&record.values).zip(kept);
    let (times, values) = pairs
        .filter(|((time, value), kept)| **kept && time.is_finite() && value.is_finite())
        .map(|((time, value), _)| (*time, *value))
        .unzip();
    let samples = Samples { times, values, rounding: record.step() / 12_f64.sqrt() };
    let Some((start, half)) = first(&samples, angular_frequency) else { return Vec::new() };
    let mut turns: Vec<Option<Local>> = track(&samples, start, half, -1.0);
    turns.reverse();
    let forward = track(&samples, start, half, 1.0);
    turns.extend(forward.into_iter().skip(1));
    runs(&samples, &turns)
}

/// Fits a sine and a constant. Returns the decrease of the mean square by the sine, and the constant, cosine
/// and sine coefficients.
fn sinusoid(points: &[(f64, f64)], frequency: f64) -> Option<(f64, [f64; 3])> {
    let count = points.len();
    let middle = points.iter().map(|point| point.1).sum::<f64>() / count as f64;
    let row = |point: &(f64, f64)| [1.0, libm::cos(frequency * point.0), libm::sin(frequency * point.0)];
    let design = DMatrix::from_row_iterator(count, 3, points.iter().flat_map(row));
    let values = DVector::from_iterator(count, points.iter().map(|point| point.1 - middle));
    let solved = design.tr_mul(&design).cholesky()?.solve(&design.tr_mul(&values));
    let rest = (&values - &design * &solved).norm_squared();
    let &[level, cosine, sine] = solved.as_slice() else { return None };
    Some(((values.norm_squared() - rest) / count as f64, [level + middle, cosine, sine]))
}

/// Returns the time of a turning point in the stretch with the largest swing, and half the period there.
fn first(samples: &Samples, angular_frequency: f64) -> Option<(f64, f64)> {
    let (begin, end) = (*samples.times.first()?, *samples.times.last()?);
    let expected = TAU / angular_frequency;
    let length = STRETCH * expected;
    if !(expected.is_finite() && expected > 0.0 && end > begin) {
        return None;
    }
    let hop = (0.5 * length).max((end - begin) / MOST_STRETCHES as f64);
    let mut best: Option<(f64, f64, f64)> = None;
    for number in 0..MOST_STRETCHES {
        let from = begin + hop * number as f64;
        if number > 0 && from + length > end {
            break;
        }
        let middle = from + 0.5 * length;
        let range: Vec<(f64, f64)> =
            samples.points(from, from + length).map(|(time, value)| (time - middle, value)).collect();
        let thinned: Vec<(f64, f64)> =
            range.iter().copied().step_by(range.len().div_ceil(MOST_SAMPLES).max(1)).collect();
        if thinned.len() < 8 {
            continue;
        }
        for step in 0..FREQUENCIES {
            let part = 2.0 * step as f64 / (FREQUENCIES - 1) as f64 - 1.0;
            let frequency = angular_frequency * libm::pow(HINT, part);
            let Some((power, [_, cosine, sine])) = sinusoid(&thinned, frequency) else { continue };
            if best.is_none_or(|(most, ..)| power > most) {
                // The extreme nearest to the middle of the stretch: a maximum or a minimum.
                let phase = libm::atan2(sine, cosine);
                let nearest = phase - PI * (phase / PI).round();
                best = Some((power, middle + nearest / frequency, PI / frequency));
            }
        }
    }
    best.map(|(_, time, half)| (time, half))
}

/// Turning point found by a local fit.
#[derive(Debug, Clone, Copy)]
struct Local {
    time: f64,
    value: f64,
    /// 1 for a maximum, −1 for a minimum.
    sign: f64,
    half: f64,
    /// Standard deviation of a sample about the fit.
    scatter: f64,
    /// Variances of value and time for samples of variance 1.
    value_leverage: f64,
    time_leverage: f64,
}

/// Tracks turning points from a first one, forward or backward; `None` for a missed one.
fn track(samples: &Samples, start: f64, half: f64, direction: f64) -> Vec<Option<Local>> {
    let (Some(&begin), Some(&end)) = (samples.times.first(), samples.times.last()) else { return Vec::new() };
    let Some(mut last) = local(samples, start, half, None) else { return Vec::new() };
    let mut half = half;
    let mut turns = vec![Some(last)];
    let mut missed = 0;
    let mut expected = last.time;
    let mut sign = last.sign;
    loop {
        expected += direction * half;
        sign = -sign;
        if expected < begin - FARTHEST * half || expected > end + FARTHEST * half || missed >= MOST_MISSED {
            break;
        }
        match local(samples, expected, half, Some(sign)) {
            Some(found) => {
                if missed == 0 {
                    half += NEWEST * ((found.time - last.time).abs() - half);
                }
                (last, expected, missed) = (found, found.time, 0);
                turns.push(Some(found));
            }
            None => {
                missed += 1;
                turns.push(None);
            }
        }
    }
    turns.truncate(turns.len() - missed);
    turns
}

/// Returns the turning point with the given sign near a time; `None` if there is no clear one.
fn local(samples: &Samples, expected: f64, half: f64, sign: Option<f64>) -> Option<Local> {
    let first = fit(samples, expected, half)?;
    // The stretch is centered on the turn that a first fit finds.
    let found = fit(samples, first.time, half)?;
    let is_near = (found.time - expected).abs() <= FARTHEST * half;
    (is_near && sign.is_none_or(|sign| sign == found.sign)).then_some(found)
}

/// Returns the terms of the local fit at a phase, or their first or second derivatives: a constant, a sine,
/// and a parabola that is used if there are enough samples.
fn terms(phase: f64, derivative: usize) -> [f64; 5] {
    let (sine, cosine) = libm::sincos(phase);
    match derivative {
        0 => [1.0, cosine, sine, phase, phase * phase],
        1 => [0.0, -sine, cosine, 1.0, 2.0 * phase],
        _ => [0.0, -cosine, -sine, 0.0, 2.0],
    }
}

/// Returns the extreme of a robust local fit about a time.
fn fit(samples: &Samples, center: f64, half: f64) -> Option<Local> {
    let reach = 2.0 * HALF_WIDTH * half;
    let points: Vec<(f64, f64)> = samples
        .points(center - reach, center + reach)
        .map(|(time, value)| (PI * (time - center) / half, value))
        .collect();
    let before = points.iter().filter(|point| point.0 < 0.0).count();
    if before < 2 || points.len() - before < 2 {
        return None;
    }
    let count = if points.len() >= FEWEST_FULL { 5 } else { 3 };
    // The first three terms may be used alone.
    let row = |phase: f64, derivative: usize| terms(phase, derivative).into_iter().take(count);
    let rows = points.iter().flat_map(|point| row(point.0, 0));
    let design = DMatrix::from_row_iterator(points.len(), count, rows);
    let values = DVector::from_iterator(points.len(), points.iter().map(|point| point.1));
    let (solved, inverse, scatter) = robust(&design, &values, samples.rounding)?;
    let at = |phase: f64, derivative: usize| DVector::from_iterator(count, row(phase, derivative));
    let mut phase = 0.0_f64;
    for _ in 0..20 {
        let step = at(phase, 1).dot(&solved) / at(phase, 2).dot(&solved);
        phase = (phase - step).clamp(-TAU * HALF_WIDTH, TAU * HALF_WIDTH);
        if step.abs() < 1e-12 {
            break;
        }
    }
    let (slope, bend) = (at(phase, 1), at(phase, 2).dot(&solved));
    let is_inside = slope.dot(&solved).abs() <= 1e-6 * bend.abs() && phase.abs() < 0.99 * TAU * HALF_WIDTH;
    let leverage = |row: &DVector<f64>| row.dot(&(&inverse * row));
    let to_seconds = half / PI;
    (is_inside && bend != 0.0).then(|| Local {
        time: center + to_seconds * phase,
        value: at(phase, 0).dot(&solved),
        sign: -bend.signum(),
        half,
        scatter,
        value_leverage: leverage(&at(phase, 0)),
        time_leverage: leverage(&slope) * (to_seconds / bend).powi(2),
    })
}

/// Returns the coefficients of a fit with Tukey's biweight, the inverse of its normal matrix, and the
/// standard deviation of a sample.
fn robust(
    design: &DMatrix<f64>,
    values: &DVector<f64>,
    rounding: f64,
) -> Option<(DVector<f64>, DMatrix<f64>, f64)> {
    let (rows, columns) = design.shape();
    let mut weights = DVector::from_element(rows, 1.0);
    // Two samples more than coefficients cannot show which one is wrong.
    let rounds = if rows >= columns + 3 { 4 } else { 1 };
    let mut found = None;
    for _ in 0..rounds {
        let weighted = DMatrix::from_fn(rows, columns, |row, column| design[(row, column)] * weights[row]);
        let inverse = weighted.tr_mul(design).cholesky()?.inverse();
        let solved = &inverse * weighted.tr_mul(values);
        let rest = values - design * &solved;
        let squares: f64 = rest.iter().zip(weights.iter()).map(|(rest, weight)| weight * rest * rest).sum();
        let freedom = (weights.sum() - columns as f64).max(1.0);
        let sizes: Vec<f64> = rest.iter().map(|rest| rest.abs()).collect();
        // The median of the residuals is too small by the share of the coefficients.
        let robust = 1.4826 * median(&sizes) * (rows as f64 / (rows as f64 - columns as f64).max(1.0)).sqrt();
        let scale = TUKEY * robust.max(rounding);
        found = Some((solved, inverse, (squares / freedom).sqrt()));
        if scale <= 0.0 {
            break;
        }
        weights = rest.map(|rest| (1.0 - (rest / scale).powi(2)).max(0.0).powi(2));
        if weights.sum() < columns as f64 + 1.0 {
            break;
        }
    }
    found
}

/// Cuts turning points into runs without gaps, from the largest swing to the last one that stands out.
fn runs(samples: &Samples, turns: &[Option<Local>]) -> Vec<Vec<Turn>> {
    let scatters: Vec<f64> = turns.iter().flatten().map(|turn| turn.scatter).collect();
    let noise = median(&scatters).max(samples.rounding);
    let turn = |local: &Local| Turn {
        time_s: local.time,
        value: local.value,
        value_variance: noise * noise * local.value_leverage,
        time_variance: noise * noise * local.time_leverage,
    };
    let amplitude = |pair: &[Option<Local>]| match pair {
        [Some(one), Some(next)] => Some(0.5 * (next.value - one.value).abs()),
        _ => None,
    };
    let amplitudes: Vec<Option<f64>> = turns.windows(2).map(amplitude).collect();
    // Turns before the largest swing belong to the release.
    let largest = amplitudes.iter().enumerate().filter_map(|(at, amplitude)| Some((at, (*amplitude)?)));
    let Some((start, _)) = largest.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))) else {
        return Vec::new();
    };
    let mut runs: Vec<Vec<Turn>> = Vec::new();
    let mut run: Vec<Turn> = Vec::new();
    for (pair, amplitude) in turns.windows(2).zip(&amplitudes).skip(start) {
        let joined = match (pair, amplitude) {
            ([Some(one), Some(next)], Some(amplitude)) => {
                let (from, to) = (turn(one), turn(next));
                let error = 0.5 * (from.value_variance + to.value_variance).sqrt();
                if *amplitude < SMALLEST * error.max(samples.rounding) {
                    break;
                }
                (samples.gap(one.time, next.time) <= LONGEST_GAP * one.half).then_some((from, to))
            }
            _ => None,
        };
        match joined {
            Some((from, to)) => {
                if run.is_empty() {
                    run.push(from);
                }
                run.push(to);
            }
            None => runs.push(std::mem::take(&mut run)),
        }
    }
    runs.push(run);
    runs.retain(|run| run.len() >= 4);
    runs
}
