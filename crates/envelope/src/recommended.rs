//! Envelope pipeline that we recommend.

use crate::envelope::{Envelope, Extraction, FEWEST_PEAKS, RatioDefinition, differences};
use crate::error::EnvelopeError;
use crate::peaks::{local_maxima, prominences};
use crate::stretches::stretches;
use nalgebra::{DMatrix, DVector};
use record::{Clock, Record, median, noise_level};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Recommended pipeline: samples as taken, on a believed clock; both half-cycles; the position and height of
/// each turning point from a polynomial fitted to the samples around it; the rest position from the turning
/// points themselves; nothing below the sensor's noise.
///
/// Turning points are not read across gaps. A gap is a step in time that is longer than three usual steps and
/// longer than half the polynomial's half-width.
///
/// The decay starts at the largest turning point; everything before it is the release.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecommendedPipeline {
    /// Half-width of the polynomial's stretch around a turning point, in periods.
    pub half_width_periods: f64,
    /// Smallest amplitude used, in units of the noise (the larger of the sensor's noise and the quantum
    /// divided by √12).
    pub floor_in_noise: f64,
}

impl RecommendedPipeline {
    /// Settings in use if a configuration sets none.
    pub const DEFAULT: Self = Self { half_width_periods: 1.0 / 6.0, floor_in_noise: 8.0 };
}

/// Most iterations of a singular value decomposition with at most five columns; about ten are usual.
const MOST_SWEEPS: usize = 1000;

/// Prominence that noise alone does not reach, in standard deviations of the noise.
const NO_WIGGLE: f64 = 8.0;

/// Quantum of the sensor, as a share of the values' range, below which rounding cannot hide the noise.
const FINE: f64 = 1e-4;

/// Half-width of the running median that is compared with the floor, in turning points.
const NEIGHBORS: usize = 2;

/// Turning point of the motion.
#[derive(Debug, Clone, Copy)]
struct Turn {
    time: f64,
    value: f64,
    /// Variance of the value for noise of variance 1.
    leverage: f64,
    /// Mean amount that noise of variance 1 adds to the value because an extremum is picked; negative at a
    /// bottom.
    lift: f64,
    /// Standard deviation of the samples about the polynomial; `None` for fewer than three degrees of
    /// freedom.
    scatter: Option<f64>,
    /// Index of the stretch between gaps that the point lies in.
    stretch: usize,
}

impl Turn {
    /// Returns ln A, corrected for the mean effect of noise: an extremum among noisy values is too high by
    /// `lift`, and the logarithm of a scattered height is too low by half its relative variance.
    fn log_amplitude(&self, center: f64, noise: f64) -> f64 {
        let amplitude = self.value - center;
        let variance = noise * noise;
        // A correction that is not small against the error would correct nothing: an almost flat top has an
        // arbitrary lift.
        let most = noise * self.leverage.sqrt() / amplitude.abs();
        let added = variance * (self.lift / amplitude - self.leverage / (2.0 * amplitude.powi(2)));
        libm::log(amplitude.abs()) - added.clamp(-most, most)
    }
}

impl RecommendedPipeline {
    /// Extracts the envelope of a record under a clock.
    ///
    /// # Errors
    /// [`EnvelopeError::TooFewPeaks`] for fewer than three turning points above the noise.
    pub fn extract(&self, record: &Record, clock: &Clock) -> Result<Extraction, EnvelopeError> {
        let values = record.values();
        let (noise, quantum) = noise_and_quantum(record);
        let floor = self.floor_in_noise * noise;

        // Prominence is measured from valley to top, which is twice the amplitude. Tops well below the floor
        // are found too, so that the cut is where the decay reaches the floor and not where noise first does.
        let least = (2.0 * floor).min(floor.max(NO_WIGGLE * noise));
        let (upper, lower) = tops(values, least);
        let too_few = |found: usize| EnvelopeError::TooFewPeaks {
            pipeline: "recommended",
            found,
            needed: FEWEST_PEAKS,
            remedy: format!(
                "Turning points must stand {floor:.2e} {} above a noise of {noise:.2e}; lower \
                 envelope.recommended.floor_in_noise, or give a longer record. A motion \
                 that stops within a few swings has no envelope.",
                record.unit()
            ),
        };
        let coarse_times = |peaks: &[usize]| -> Vec<f64> {
            peaks.iter().filter_map(|&peak| clock.times_s.get(peak).copied()).collect()
        };
        let periods =
            [&upper, &lower].into_iter().flat_map(|peaks| differences(&coarse_times(peaks), 1)).collect();
        let coarse_period = median(periods).ok_or_else(|| too_few(upper.len() + lower.len()))?;

        let half_width = self.half_width_periods * coarse_period;
        let turns = turning_points(&clock.times_s, values, least, half_width);

        let offset = center(&turns).ok_or_else(|| too_few(turns.len()))?;
        let decay = free_decay(&turns, offset, floor, coarse_period);
        if decay.len() < FEWEST_PEAKS {
            return Err(too_few(decay.len()));
        }
        let times: Vec<f64> = decay.iter().map(|turn| turn.time).collect();
        let noise =
            median(decay.iter().filter_map(|turn| turn.scatter).collect()).unwrap_or(noise_level(values));
        let log_amplitudes = decay.iter().map(|turn| turn.log_amplitude(offset, noise)).collect();
        let errors = log_std_errors(&decay, offset, noise, quantum);
        let period_s = median(two_apart(&decay)).unwrap_or(coarse_period);
        let first = decay.first().map(|turn| turn.time).ok_or_else(|| too_few(0))?;
        Ok(Extraction {
            pipeline: "recommended",
            because: None,
            first_peak_s: first - clock.start_s(),
            envelope: Envelope::new(times, log_amplitudes, TAU / period_s)?
                .with_log_std_errors(errors)
                .with_ratio(RatioDefinition::LogarithmicDecrement),
            period_s,
            offset,
            samples: values.len(),
        })
    }
}

/// Returns the noise, of which rounding is a part, and the step of the values; 0 for a step if there is none.
fn noise_and_quantum(record: &Record) -> (f64, f64) {
    let values = record.values();
    let quantum = record.quantum();
    let noise = match noise_level(values) {
        // A log that is filled up with zeros is constant in most of its samples; the noise is in the others.
        0.0 if quantum < FINE * range(values) => noise_level(&moving(values)),
        level => level,
    };
    (noise.max(quantum / 12_f64.sqrt()), quantum)
}

fn range(values: &[f64]) -> f64 {
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    highest - values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Returns the values without those that equal both neighbors.
fn moving(values: &[f64]) -> Vec<f64> {
    let inner = values.windows(3).filter(|part| part.iter().any(|value| Some(value) != part.first()));
    inner.filter_map(|part| part.get(1).copied()).collect()
}

/// Returns the tops and bottoms with at least the given prominence.
fn tops(values: &[f64], least: f64) -> (Vec<usize>, Vec<usize>) {
    (prominent(values.to_vec(), least), prominent(values.iter().map(|value| -value).collect(), least))
}

/// Part of the half-width that must be seen between a turning point and a gap.
const SEEN: f64 = 0.5;

/// Returns turning points in the order of their times. Each comes from samples between the same gaps; a point
/// is left out if a gap cuts off one of its sides.
fn turning_points(times: &[f64], values: &[f64], least: f64, half_width: f64) -> Vec<Turn> {
    let margin = SEEN * half_width;
    let mut turns = Vec::new();
    for (stretch, range) in stretches(times, margin).into_iter().enumerate() {
        let (Some(own), Some(seen)) = (times.get(range.clone()), values.get(range.clone())) else {
            continue;
        };
        let bound = |is_gap: bool, end: Option<&f64>, inward: f64, open: f64| {
            end.filter(|_| is_gap).map_or(open, |time| time + inward)
        };
        let from = bound(range.start > 0, own.first(), margin, f64::NEG_INFINITY);
        let to = bound(range.end < times.len(), own.last(), -margin, f64::INFINITY);
        let (upper, lower) = tops(seen, least);
        let mut indices = [upper, lower].concat();
        indices.sort_unstable();
        let found = indices.iter().filter_map(|&at| turning_point(own, seen, at, half_width));
        let found = found.filter(|turn| turn.time >= from && turn.time <= to);
        turns.extend(found.map(|turn| Turn { stretch, ..turn }));
    }
    turns
}

/// Returns the times between turning points on the same side, which are two apart unless a gap lies between
/// them.
fn two_apart(turns: &[Turn]) -> Vec<f64> {
    let pairs = turns.iter().zip(turns.iter().skip(2));
    pairs.filter(|(one, next)| one.stretch == next.stretch).map(|(one, next)| next.time - one.time).collect()
}

/// Returns the indices of the tops with at least the given prominence, one per top. Noise can make several
/// samples of one top equally high, and each of them is as prominent as the top.
fn prominent(values: Vec<f64>, least: f64) -> Vec<usize> {
    let maxima = local_maxima(&values);
    let prominences = prominences(&values, &maxima);
    let is_top = |prominence: f64| prominence >= least && prominence > 0.0;
    let mut tops: Vec<usize> = Vec::new();
    for (peak, _) in maxima.into_iter().zip(prominences).filter(|(_, prominence)| is_top(*prominence)) {
        let height = |at: usize| values.get(at).copied().unwrap_or(f64::NAN);
        let same = tops.last().is_some_and(|&last| {
            let valley = values.iter().take(peak).skip(last).copied().fold(f64::INFINITY, f64::min);
            !is_top(height(last).min(height(peak)) - valley)
        });
        if !same {
            tops.push(peak);
        }
    }
    tops
}

/// Returns the turning point near a sample. The highest of noisy samples may lie well beside the top, so the
/// polynomial is fitted a second time around the top that the first fit finds.
fn turning_point(times: &[f64], values: &[f64], at: usize, half_width: f64) -> Option<Turn> {
    let first = refine(times, values, at, *times.get(at)?, half_width)?;
    let near =
        times.partition_point(|&time| time < first.time).clamp(1, times.len().saturating_sub(2).max(1));
    refine(times, values, near, first.time, half_width).or(Some(first))
}

/// Returns the standard error of each turning point's ln A. If the noise exceeds half a quantum, rounding
/// errors are independent and already part of the scatter. Below that, all samples of a flat top are rounded
/// alike, and averaging does not help.
fn log_std_errors(decay: &[Turn], center: f64, noise: f64, quantum: f64) -> Vec<f64> {
    let rounding = if noise < quantum / 2.0 { quantum.powi(2) / 12.0 } else { 0.0 };
    let error = |turn: &Turn| (noise.powi(2) * turn.leverage + rounding).sqrt() / (turn.value - center).abs();
    decay.iter().map(error).collect()
}

/// Returns time and value of the turning point near a sample: the stationary point of a polynomial fitted to
/// the samples within `half_width` of `center`. The polynomial is a quartic if there are enough samples, so
/// that the shape of a swing does not bias the height; else a parabola. `None` if there are too few samples
/// for a parabola, or if the stationary point falls outside the stretch.
fn refine(times: &[f64], values: &[f64], at: usize, center: f64, half_width: f64) -> Option<Turn> {
    let from = times.partition_point(|&time| time < center - half_width);
    let to = times.partition_point(|&time| time <= center + half_width);
    // A coarse record may have no neighbors inside the stretch; then take the nearest ones.
    let (from, to) = (from.min(at.saturating_sub(1)), to.max(at + 2).min(times.len()));
    let (times, values) = (times.get(from..to)?, values.get(from..to)?);
    let order = match values.len() {
        0..=2 => return None,
        3..=8 => 2,
        _ => 4,
    };
    let scale = times.iter().map(|time| (time - center).abs()).fold(0.0, f64::max);
    // A burst on the host's clock: no time passes, so that there is nothing to fit over.
    if scale <= 0.0 {
        return None;
    }
    let powers = (0..=order as i32)
        .flat_map(|power| times.iter().map(move |time| ((time - center) / scale).powi(power)));
    let design = DMatrix::from_iterator(values.len(), order + 1, powers);
    // Without a limit the decomposition would not terminate on entries that are not finite.
    let decomposition = design.clone().try_svd(true, true, 5.0 * f64::EPSILON, MOST_SWEEPS)?;
    let solution = decomposition.solve(&DVector::from_row_slice(values), 1e-12).ok()?;
    let coefficients: Vec<f64> = solution.iter().copied().collect();
    // Newton's method on the derivative, from the stretch's center; it needs few steps on a smooth top.
    let mut u = 0.0;
    for _ in 0..20 {
        let (_, slope, curvature) = evaluate(&coefficients, u);
        let step = slope / curvature;
        if !step.is_finite() {
            return None;
        }
        u -= step;
        if step.abs() < 1e-13 {
            break;
        }
    }
    if u.abs() > 1.0 {
        return None;
    }
    let residuals = &design * &solution - DVector::from_row_slice(values);
    let left_over = values.len().saturating_sub(order + 1);
    let scatter = (left_over >= 3).then(|| (residuals.norm_squared() / left_over as f64).sqrt());
    // Variance of a combination of the coefficients for noise of variance 1.
    let variance = |combination: DVector<f64>| -> Option<f64> {
        let projected = decomposition.v_t.as_ref()? * combination;
        let shares = projected.iter().zip(decomposition.singular_values.iter());
        Some(
            shares
                .filter(|(_, singular)| **singular > 0.0)
                .map(|(part, singular)| (part / singular).powi(2))
                .sum(),
        )
    };
    let leverage = variance(DVector::from_fn(order + 1, |power, _| u.powi(power as i32)))?;
    let slope =
        variance(DVector::from_fn(order + 1, |power, _| power as f64 * u.powi((power as i32 - 1).max(0))))?;
    let (value, _, curvature) = evaluate(&coefficients, u);
    let lift = -slope / (2.0 * curvature);
    Some(Turn { time: center + u * scale, value, leverage, lift, scatter, stretch: 0 })
}

/// Returns value, first and second derivative of a polynomial with rising powers.
fn evaluate(coefficients: &[f64], u: f64) -> (f64, f64, f64) {
    coefficients.iter().rev().fold((0.0, 0.0, 0.0), |(value, slope, curvature), coefficient| {
        (value * u + coefficient, slope * u + value, curvature * u + 2.0 * slope)
    })
}

/// Returns the position that successive turning points swing about: the median, over three in a row, of the
/// center about which they decay geometrically (Aitken's delta-squared), a weighted mean near (1, 2, 1)/4.
fn center(turns: &[Turn]) -> Option<f64> {
    median(
        turns
            .windows(3)
            .filter_map(|part| match part {
                [a, b, c] if a.stretch == c.stretch => Some(
                    b.value - (b.value - a.value) * (c.value - b.value) / (c.value - 2.0 * b.value + a.value),
                ),
                _ => None,
            })
            .collect(),
    )
}

/// Returns the turning points from the largest one on, until their running median falls to the floor or the
/// motion stays on one side of the center for longer than a period.
fn free_decay(turns: &[Turn], center: f64, floor: f64, period: f64) -> Vec<Turn> {
    let size = |turn: &Turn| (turn.value - center).abs();
    let turns = alternating(turns, center, period);
    let largest = turns.iter().enumerate().max_by(|(_, a), (_, b)| size(a).total_cmp(&size(b)));
    let Some((largest, _)) = largest else { return turns };
    let turns: Vec<Turn> = turns.iter().skip(largest).copied().collect();
    let is_above_floor = |at: usize| {
        let near = turns.iter().take(at + NEIGHBORS + 1).skip(at.saturating_sub(NEIGHBORS));
        median(near.map(size).collect()).is_some_and(|size| size > floor)
    };
    turns.iter().enumerate().take_while(|(at, _)| is_above_floor(*at)).map(|(_, turn)| *turn).collect()
}

/// Returns one turning point per half swing, the outermost: a wrong reading creates others beside it. The
/// decay ends where turning points on one side follow each other for longer than a period, since nothing
/// swings there. Two of them further apart than a period belong to different swings, with a gap between them.
fn alternating(turns: &[Turn], center: f64, period: f64) -> Vec<Turn> {
    let mut found: Vec<Turn> = Vec::new();
    let (mut begun, mut latest) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    for turn in turns {
        let same =
            |last: &Turn| last.stretch == turn.stretch && (last.value > center) == (turn.value > center);
        match found.last_mut().filter(|last| same(last) && turn.time - latest <= period) {
            Some(_) if turn.time - begun > period => break,
            Some(last) if (last.value - center).abs() < (turn.value - center).abs() => *last = *turn,
            Some(_) => {}
            None => {
                begun = turn.time;
                found.push(*turn);
            }
        }
        latest = turn.time;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{Turn, alternating, prominent, refine};

    fn turns(points: &[(f64, f64)]) -> Vec<Turn> {
        let turn = |&(time, value): &(f64, f64)| Turn {
            time,
            value,
            leverage: 0.0,
            lift: 0.0,
            scatter: None,
            stretch: 0,
        };
        points.iter().map(turn).collect()
    }

    /// Found on a measured swing in air: one wrong reading beside a top ended a decay of 158 tops after five.
    #[test]
    fn a_wrong_reading_beside_a_top_is_no_swing_of_its_own() {
        let seen =
            turns(&[(0.0, 1.0), (0.5, -0.9), (0.9, 0.7), (1.0, 0.8), (1.5, -0.7), (4.5, -0.5), (5.0, 0.4)]);
        let kept: Vec<f64> = alternating(&seen, 0.0, 1.0).iter().map(|turn| turn.time).collect();
        assert_eq!(kept, [0.0, 0.5, 1.0, 1.5, 4.5, 5.0]);
    }

    #[test]
    fn what_stays_on_one_side_ends_the_decay() {
        let stuck = (0..20).map(|i| (1.0 + 0.1 * f64::from(i), 0.1));
        let seen: Vec<(f64, f64)> = [(0.0, 1.0), (0.5, -0.5)].into_iter().chain(stuck).collect();
        assert_eq!(alternating(&turns(&seen), 0.0, 1.0).len(), 3);
    }

    /// Found by simulated decays: equal readings of one top ended the decay there.
    #[test]
    fn equal_readings_of_one_top_are_one_top() {
        let values = vec![0.0, 2.0, 5.0, 4.9, 5.0, 2.0, 0.0, 1.0, 4.0, 3.0, 0.0];
        assert_eq!(prominent(values, 1.0), [2, 8]);
    }

    /// Found by fuzzing: samples around a turning point that share one stamp were fitted although no time
    /// passes.
    #[test]
    fn a_burst_on_one_stamp_has_no_turning_point_and_an_end() {
        let times = [0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0];
        let values = [0.0, 1.0, 2.0, 3.0, 2.0, 1.0, 0.0];
        assert!(refine(&times, &values, 3, 1.0, 0.1).is_none());
        assert!(refine(&times, &values, 3, 1.0, 1.0).is_some());
    }
}
