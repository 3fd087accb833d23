//! Multiple shooting: records cut into segments, each with a start state of its own.
//!
//! With a single start state for a whole record the phase wraps and the fit falls into local minima; a
//! segment of a few periods avoids this. Each segment is independent of what came before it, so that the fit
//! finds the law and not the history.

#![allow(clippy::indexing_slicing, reason = "`cut` checks that there are samples in every segment")]

use crate::data::checks::{check, only, span};
use crate::data::observations::Observations;
use crate::data::pieces::{Piece, pieces};
use crate::data::scales::{Repeats, Scales};
use crate::error::DiagnosisError;
use crate::matrices::solve;
use crate::noise::periodogram::{dominant_frequency, share};
use crate::noise::statistics::{duration, median, quantile};
use dynamics::{Hold, Input, Nominal, NominalSimulator};
use record::Quantity;
use std::f64::consts::TAU;
use std::ops::Range;

/// Number of periods in a segment.
pub(crate) const PERIODS: f64 = 6.0;

/// Number of time constants I/c in a segment if there is no spring.
const TIME_CONSTANTS: f64 = 3.0;

/// Minimum number of samples of a segment.
const FEWEST_PER_SEGMENT: usize = 24;

/// Maximum number of samples that a search uses. Longer data are strided while a swing is still well sampled,
/// and then thinned by whole segments, so that the time of an answer is bounded.
pub(crate) const MOST_SEARCHED: usize = 20_000;

/// Number of samples per period that a search uses.
const SEARCHED_PER_PERIOD: f64 = 20.0;

/// Minimum share of the input's squares in the line at which a motion repeats; below it the repetition is not
/// the input's.
const LINE_OF_INPUT: f64 = 0.1;

/// Maximum number of samples used to find the repetition of a driven motion.
const MOST_REPEATED: usize = 4000;

/// Number of steps of the sensor that a motion has to span to be visible.
const FEW_STEPS: f64 = 2.5;

/// Part of its largest excursion above which a motion counts as visible.
const VISIBLE: f64 = 0.02;

/// Stretch of a record with a start state of its own. It has at least one sample; [`cut`] checks it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Segment {
    /// Index of the record.
    pub(crate) record: usize,
    /// `true` if the record begins with this segment: hidden states are relaxed then.
    pub(crate) first: bool,
    pub(crate) times: Vec<f64>,
    pub(crate) values: Vec<f64>,
    /// `true` if all readings are equal: the body is at rest.
    pub(crate) still: bool,
    /// Index of the first sample of each segment that this one was joined from; `[0]` for a segment as it was
    /// cut.
    pub(crate) parts: Vec<usize>,
    /// Position and velocity from which a fit of the start state begins.
    pub(crate) guess: [f64; 2],
    /// Index of the stretch between gaps of the input. Segments of two stretches are never joined.
    pub(crate) stretch: usize,
}

/// All segments, with the data they share.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Data {
    pub(crate) segments: Vec<Segment>,
    /// Input of each record.
    pub(crate) inputs: Vec<Option<Input>>,
    pub(crate) quantity: Quantity,
    pub(crate) facts: Scales,
    /// Measured period of a free swing in seconds; `None` if there is none to measure.
    pub(crate) period_s: Option<f64>,
    /// Step of the sensor, if the readings lie on a lattice.
    pub(crate) resolution: Option<f64>,
}

impl Segment {
    /// Returns the time from the first sample to the last, in seconds.
    pub(crate) fn span(&self) -> f64 {
        duration(&self.times)
    }

    /// Returns the time of the first sample, in seconds.
    pub(crate) fn start_s(&self) -> f64 {
        self.times[0]
    }

    /// Returns the sample ranges of the segments that this one was joined from.
    pub(crate) fn part_ranges(&self) -> impl Iterator<Item = Range<usize>> {
        let ends = self.parts.iter().skip(1).copied().chain([self.times.len()]);
        self.parts.iter().copied().zip(ends).map(|(from, to)| from..to)
    }
}

impl Data {
    /// Returns the span of the longest segment, in seconds.
    pub(crate) fn longest_span(&self) -> f64 {
        self.segments.iter().map(Segment::span).fold(0.0, f64::max)
    }

    pub(crate) fn samples(&self) -> usize {
        self.segments.iter().map(|segment| segment.times.len()).sum()
    }

    /// Returns the data with only the segments that `keep` accepts by index.
    pub(crate) fn only(&self, keep: impl Fn(usize) -> bool) -> Self {
        let segments = self.segments.iter().enumerate().filter(|(index, _)| keep(*index));
        Self { segments: segments.map(|(_, segment)| segment.clone()).collect(), ..self.clone() }
    }

    /// Returns the mean time between the samples of a segment, in seconds. It is longer than that of the
    /// record if the data are strided.
    pub(crate) fn interval(&self) -> f64 {
        let steps: usize = self.segments.iter().map(|segment| segment.times.len().saturating_sub(1)).sum();
        let spans = self.segments.iter().filter_map(|s| Some(s.times.last()? - s.times.first()?));
        spans.sum::<f64>() / steps.max(1) as f64
    }

    /// Strides the samples down to about `most`, but to no fewer per period than a search needs.
    pub(crate) fn sparser(&self, most: usize) -> Self {
        let wanted = self.samples().div_ceil(most.max(1));
        self.every(wanted.min(self.spare()))
    }

    /// Returns the largest stride that leaves enough samples for a search, in a period and in the shortest
    /// segment.
    fn spare(&self) -> usize {
        let per_period = TAU / (self.facts.frequency * self.interval());
        let Some(fewest) = self.segments.iter().map(|s| s.times.len()).min() else { return 1 };
        ((per_period / SEARCHED_PER_PERIOD) as usize).min(fewest / FEWEST_PER_SEGMENT).max(1)
    }

    fn every(&self, stride: usize) -> Self {
        let segments = self.segments.iter().map(|segment| Segment {
            times: segment.times.iter().copied().step_by(stride).collect(),
            values: segment.values.iter().copied().step_by(stride).collect(),
            parts: segment.parts.iter().map(|at| at.div_ceil(stride)).collect(),
            ..segment.clone()
        });
        Self { segments: segments.collect(), ..self.clone() }
    }

    /// Thins the data to about `most` samples by leaving out whole segments. The kept ones are evenly spaced
    /// pairs of neighbors, so that both even and odd segments remain.
    pub(crate) fn thinned(&self, most: usize) -> Self {
        let samples = self.samples();
        if samples <= most {
            return self.clone();
        }
        let pairs = self.segments.len().div_ceil(2);
        let wanted = ((pairs * most / samples).max(2)).min(pairs);
        let kept: Vec<usize> = (0..wanted).map(|at| at * pairs / wanted).collect();
        self.only(|index| kept.binary_search(&(index / 2)).is_ok())
    }

    /// Strides the samples for a search: a swing sampled 75 times a period says hardly more about its law
    /// than one sampled 20 times.
    pub(crate) fn strided(&self) -> Self {
        self.every(self.spare())
    }

    /// Returns the same data, to be integrated with the accuracy that suits a noise of this size.
    pub(crate) fn for_noise(&self, noise: f64) -> Self {
        let values = || self.segments.iter().flat_map(|segment| segment.values.iter().copied());
        let span = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
        Self { facts: self.facts.with_noise(noise, 0.5 * span), ..self.clone() }
    }

    pub(crate) fn driven(&self) -> bool {
        self.inputs.iter().any(Option::is_some)
    }

    /// Returns the same data with another hold of the input between its samples.
    pub(crate) fn holding(&self, hold: Hold) -> Result<Self, DiagnosisError> {
        let inputs = self.inputs.iter().map(|input| {
            input.as_ref().map(|i| Input::new(i.times().to_vec(), i.values().to_vec(), hold)).transpose()
        });
        Ok(Self { inputs: inputs.collect::<Result<_, _>>()?, ..self.clone() })
    }
}

/// Checks records against the nominal simulator and cuts them into segments. `kept` is `true` for each sample
/// that is not an outlier.
pub(crate) fn cut(
    records: &[Observations],
    kept: &[Vec<bool>],
    simulator: &NominalSimulator,
) -> Result<Data, DiagnosisError> {
    let first = records.first().ok_or(DiagnosisError::NoRecord)?;
    let mut swings = Vec::new();
    for (index, (record, kept)) in records.iter().zip(kept).enumerate() {
        swings.push(check(index + 1, (record, kept), first, simulator)?);
    }
    let measured: Vec<f64> = swings.iter().flatten().copied().collect();
    let period_s = (!measured.is_empty()).then(|| median(&measured));
    let facts = facts(records, simulator, period_s);
    let mut segments = Vec::new();
    let mut inputs = Vec::new();
    for (number, (record, kept)) in records.iter().zip(kept).enumerate() {
        inputs.push(input(record)?);
        let times: Vec<f64> = only(&record.times_s, kept);
        let values: Vec<f64> = only(&record.values, kept);
        let (count, length, end) = cuts(record, simulator, period_s, &times, &values);
        let samples = times.iter().copied().zip(values.iter().copied());
        let samples = samples.take_while(|(time, _)| *time <= end);
        for Piece { at, stretch, times, values } in pieces(record, (count, length), samples) {
            // Dropouts may nearly empty a segment. The few samples that remain say nothing beside two free
            // start values.
            if times.len() < FEWEST_PER_SEGMENT / 2 {
                continue;
            }
            if at > 1 && swings_within(&values, record.resolution) {
                continue;
            }
            let guess = guess(&times, &values, record.quantity, &facts, period_s, simulator);
            let still = values.iter().zip(values.iter().skip(1)).all(|(before, after)| before == after);
            let first = at == 0 && stretch == 0 && kept.first() == Some(&true);
            let (record, parts) = (number, vec![0]);
            segments.push(Segment { record, first, times, values, still, parts, guess, stretch });
        }
    }
    if segments.is_empty() {
        let reason =
            format!("no stretch of {PERIODS} periods holds {} samples in motion", FEWEST_PER_SEGMENT / 2);
        return Err(DiagnosisError::NotFitted { reason });
    }
    let resolution = first.resolution;
    Ok(Data { segments, inputs, quantity: first.quantity, facts, period_s, resolution })
}

/// Returns `true` if all values lie on a few neighboring steps of the sensor. Motion between the steps is not
/// visible, and rounding then follows the motion instead of acting as noise. Constant values return `false`:
/// the body is at rest, which is information.
fn swings_within(values: &[f64], resolution: Option<f64>) -> bool {
    let span = span(values);
    span > 0.0 && resolution.is_some_and(|step| span <= FEW_STEPS * step)
}

fn input(record: &Observations) -> Result<Option<Input>, DiagnosisError> {
    let Some(values) = &record.input else { return Ok(None) };
    // Two inputs at the same time are no function of time; the last of each group is kept.
    let mut times: Vec<f64> = Vec::new();
    let mut kept: Vec<f64> = Vec::new();
    let sampled = record.times_s.iter().copied().zip(values.iter().copied());
    let mut all: Vec<(f64, f64)> = sampled.chain(record.input_rows.iter().copied()).collect();
    all.sort_by(|one, other| one.0.total_cmp(&other.0));
    for (time, value) in all {
        if times.last() == Some(&time) {
            times.pop();
            kept.pop();
        }
        times.push(time);
        kept.push(value);
    }
    Ok(Some(Input::new(times, kept, Hold::Linear)?))
}

/// Returns the number of segments of a record, their length in seconds, and the time at which the last one
/// ends.
///
/// A swing that comes to rest within less than one and a half segments is still cut into two. Of the rest
/// that follows, only as much is kept as there was motion, because further samples at rest add no information.
fn cuts(
    record: &Observations,
    simulator: &NominalSimulator,
    period_s: Option<f64>,
    times: &[f64],
    values: &[f64],
) -> (usize, f64, f64) {
    let (nominal, omega) = (simulator.nominal(), simulator.angular_frequency());
    let wanted = match period_s {
        Some(period) => PERIODS * period,
        None if omega > 0.0 => PERIODS * TAU / omega,
        None if nominal.damping() > 0.0 => TIME_CONSTANTS * nominal.inertia() / nominal.damping(),
        None => record.duration_s() / 20.0,
    };
    let moving = moving_until(record, times, values);
    let most = (times.len() / FEWEST_PER_SEGMENT).max(2);
    if record.input.is_none() && moving < 1.5 * wanted && 2.0 * moving < record.duration_s() {
        return (2, 0.5 * moving, 2.0 * moving);
    }
    let count = ((record.duration_s() / wanted).round() as usize).min(most).max(2);
    (count, record.duration_s() / count as f64, record.duration_s())
}

/// Returns the time at which the last visible motion ends, in seconds; 0 if none is visible.
fn moving_until(record: &Observations, times: &[f64], values: &[f64]) -> f64 {
    // Fewer than ten samples have no last tenth; the rest position is then taken to be zero.
    let rest = median(&values[values.len() - values.len() / 10..]);
    let span = values.iter().map(|value| (value - rest).abs()).fold(0.0, f64::max);
    let visible = (3.0 * record.step()).min(0.5 * span).max(VISIBLE * span);
    let moving = times.iter().zip(values).filter(|(_, value)| (**value - rest).abs() > visible);
    moving.map(|(time, _)| *time).fold(0.0, f64::max)
}

/// Returns the largest of a number of every record, at least 0.
fn most(records: &[Observations], of: impl Fn(&Observations) -> f64) -> f64 {
    records.iter().map(of).fold(0.0, f64::max)
}

fn facts(records: &[Observations], simulator: &NominalSimulator, period_s: Option<f64>) -> Scales {
    let (nominal, omega) = (simulator.nominal(), simulator.angular_frequency());
    let frequency = match period_s {
        Some(period) => TAU / period,
        None if omega > 0.0 => omega,
        None => (nominal.damping() / nominal.inertia()).max(1e-9),
    };
    let quantity = records.first().map_or(Quantity::Position, |record| record.quantity);
    let to_position = match quantity {
        Quantity::Position => 1.0,
        Quantity::Velocity => 1.0 / frequency,
        Quantity::Acceleration => 1.0 / (frequency * frequency),
    };
    let (rest, _) = simulator.equilibrium();
    // Rates swing about zero, positions about the equilibrium.
    let center = if quantity == Quantity::Position { 0.0 } else { rest };
    let values = || records.iter().flat_map(|record| record.values.iter().copied());
    let highest = center + to_position * values().fold(f64::NEG_INFINITY, f64::max);
    let lowest = center + to_position * values().fold(f64::INFINITY, f64::min);
    let amplitude = (highest - rest).abs().max((lowest - rest).abs());
    let input = records.iter().filter_map(|record| record.input.as_ref()).flatten();
    let input_torque = input.fold(0.0, |most: f64, u| most.max(u.abs())) * nominal.input_gain().abs();
    let stiffness = nominal.inertia() * frequency * frequency;
    let drive_torque = match quantity {
        Quantity::Position => drive_torque(records, nominal),
        _ => input_torque + if input_torque > 0.0 { nominal.stiffness() * amplitude } else { 0.0 },
    };
    let reading = values().fold(0.0, |most: f64, value| most.max(value.abs()));
    let speed = match quantity {
        _ if omega != 0.0 => amplitude * frequency,
        Quantity::Position => speed(records),
        Quantity::Velocity => reading,
        Quantity::Acceleration => reading / frequency,
    };
    Scales {
        amplitude,
        highest,
        lowest,
        reading,
        speed,
        frequency,
        torque: stiffness * amplitude,
        input_torque,
        drive_torque,
        drive_error: if nominal.stiffness() > 0.0 { drive_torque / nominal.stiffness() } else { 0.0 },
        duration: most(records, Observations::duration_s),
        interval: interval(records),
        rest_moved: rest - nominal.rest_angle(),
        friction_known: knows_friction(simulator),
        inertia: nominal.inertia(),
        stiffness,
        resolution: records.iter().filter_map(|record| record.resolution).fold(0.0, f64::max),
        repeats: records.iter().find(|record| record.input.is_some()).and_then(repeats),
        rate_error: most(records, |record| record.rate_error),
        tolerance: Scales::UNKNOWN_NOISE,
        noise: 0.0,
        damping: nominal.damping(),
        drive_noise: most(records, |record| record.drive_noise),
    }
}

/// Returns the median time between samples, in seconds.
fn interval(records: &[Observations]) -> f64 {
    let steps: Vec<f64> = records
        .iter()
        .flat_map(|r| r.times_s.iter().zip(r.times_s.iter().skip(1)).map(|(a, b)| b - a))
        .filter(|step| *step > 0.0)
        .collect();
    median(&steps).max(f64::MIN_POSITIVE)
}

/// Returns the largest torque of input and nominal spring together, from the positions of driven records. Where a
/// servo starts from rest the spring of its drive is stretched most, and its damping has no torque yet.
fn drive_torque(records: &[Observations], nominal: &Nominal) -> f64 {
    let of = |record: &Observations| {
        let inputs = record.input.iter().flatten();
        let spring = |value: &f64| nominal.stiffness() * (value - nominal.rest_angle());
        let torques =
            inputs.zip(&record.values).map(|(u, value)| (nominal.input_gain() * u - spring(value)).abs());
        torques.fold(0.0, f64::max)
    };
    most(records, of)
}

/// Returns `true` if the simulator has Coulomb friction whose torque is recalibrated.
fn knows_friction(simulator: &NominalSimulator) -> bool {
    simulator.effects().iter().any(|known| known.recalibrate && known.active.id() == "coulomb_friction")
}

/// Returns the repetition of a driven motion: the line that holds most of its squares, provided that the
/// input has that line too. Otherwise the line has another cause, and the result is `None`.
fn repeats(record: &Observations) -> Option<Repeats> {
    let stride = record.len().div_ceil(MOST_REPEATED);
    let times: Vec<f64> = record.times_s.iter().copied().step_by(stride).collect();
    let values: Vec<f64> = record.values.iter().copied().step_by(stride).collect();
    let frequency = dominant_frequency(&times, &values)?;
    let input: Vec<f64> = record.input.iter().flatten().copied().step_by(stride).collect();
    (share(&times, &input, frequency) > LINE_OF_INPUT).then_some(())?;
    Some(Repeats { frequency, resolution: TAU / record.duration_s() })
}

/// Returns a large speed (95 % quantile) of a drive without a spring, from differences of positions over
/// stretches of samples.
fn speed(records: &[Observations]) -> f64 {
    let mut speeds = Vec::new();
    for record in records {
        let stride = (record.len() / 500).max(1);
        let points: Vec<(f64, f64)> =
            record.times_s.iter().copied().zip(record.values.iter().copied()).step_by(stride).collect();
        let steps = points.iter().zip(points.iter().skip(1)).filter(|(a, b)| b.0 > a.0);
        speeds.extend(steps.map(|(a, b)| ((b.1 - a.1) / (b.0 - a.0)).abs()));
    }
    quantile(&speeds, 0.95).max(f64::MIN_POSITIVE)
}

/// Frequencies that a segment may begin with, over that of the records, and the share of the usual one's squares
/// that another has to come below.
const LOCAL: [f64; 8] = [0.4, 0.55, 0.7, 0.85, 1.2, 1.45, 1.8, 2.2];
const CLOSER: f64 = 0.5;

/// Fits an offset and a wave of an angular frequency to points, or a parabola without one. Returns offset, cosine
/// and sine (or the parabola's coefficients), and the sum of squares that is left.
fn wave(points: &[(f64, f64)], omega: Option<f64>) -> ([f64; 3], f64) {
    let columns = |time: f64| match omega {
        Some(omega) => [1.0, libm::cos(omega * time), libm::sin(omega * time)],
        None => [1.0, time, time * time],
    };
    let rows = points.iter().flat_map(|(time, _)| columns(*time));
    let design = nalgebra::DMatrix::from_row_iterator(points.len(), 3, rows);
    let right = nalgebra::DMatrix::from_iterator(points.len(), 1, points.iter().map(|(_, value)| *value));
    let fit = solve(&design.tr_mul(&design), &design.tr_mul(&right));
    let fit = fit.unwrap_or_else(|| nalgebra::DMatrix::zeros(3, 1));
    ([0, 1, 2].map(|index| fit[index]), (right - design * fit).norm_squared())
}

/// Estimates position and velocity at the start of a segment: from a harmonic with an offset through its
/// first period, or from a parabola through its first samples if nothing swings. The harmonic has the frequency
/// of the records, or one of its [`LOCAL`] multiples if that leaves far less.
fn guess(
    times: &[f64],
    values: &[f64],
    quantity: Quantity,
    facts: &Scales,
    period_s: Option<f64>,
    simulator: &NominalSimulator,
) -> [f64; 2] {
    let start = times[0];
    let omega = facts.frequency;
    let (rest, stiffness) = simulator.equilibrium();
    let reach = match period_s {
        Some(period) => 0.6 * period,
        None if stiffness > 0.0 => 0.25 * TAU / omega,
        None => 12.0 * facts.interval,
    };
    let points: Vec<(f64, f64)> = times
        .iter()
        .zip(values)
        .map(|(time, value)| (time - start, *value))
        .enumerate()
        .take_while(|(index, (time, _))| *index < 6 || *time <= reach)
        .map(|(_, point)| point)
        .collect();
    // A law far from a spring's has other frequencies at other amplitudes.
    let others: &[f64] = if period_s.is_some() { &LOCAL } else { &[] };
    let tried = others.iter().map(|factor| (factor * omega, wave(&points, Some(factor * omega))));
    let own = wave(&points, period_s.map(|_| omega));
    let (omega, (coefficients, _)) = tried
        .filter(|(_, (_, squares))| *squares < CLOSER * own.1)
        .min_by(|a, b| a.1.1.total_cmp(&b.1.1))
        .unwrap_or((omega, own));
    let [offset, cosine, sine] = coefficients;
    match (quantity, period_s.is_some()) {
        (Quantity::Position, true) => [offset + cosine, omega * sine],
        (Quantity::Position, false) => [offset, cosine],
        // v = −A·ω·sin + B·ω·cos about the rest angle.
        (Quantity::Velocity, true) => [rest - sine / omega, cosine],
        (Quantity::Velocity, false) => [rest, offset],
        (Quantity::Acceleration, true) => [rest - cosine / (omega * omega), -sine / omega],
        // Without a swing, an acceleration tells the spring's pull but not the speed.
        (Quantity::Acceleration, false) => [rest - offset / (omega * omega), 0.0],
    }
}

#[cfg(test)]
mod tests {
    use super::{SEARCHED_PER_PERIOD, cut};
    use crate::Observations;
    use record::{Clock, ClockChoice, Quantity, Record};

    /// 275 samples a period, as at 600 Hz, of which there are twice as many as a search takes.
    #[test]
    fn data_strided_twice_still_sample_a_swing_well() {
        let times: Vec<f64> = (0..40_000).map(|at| f64::from(at) / 600.0).collect();
        let values = times.iter().map(|t| 0.3 * libm::exp(-0.02 * t) * libm::cos(13.7 * t)).collect();
        let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
        let clock = Clock::new(&record, ClockChoice::Host).unwrap();
        let nominal = dynamics::Nominal::new(1.0, 0.04, 13.7 * 13.7, 0.0).unwrap();
        let kept = [vec![true; 40_000]];
        let all = cut(&[Observations::new(&record, &clock)], &kept, &(&nominal).into()).unwrap();
        let searched = all.sparser(10_000).strided();
        let per_period = std::f64::consts::TAU / 13.7 / searched.interval();
        assert!((SEARCHED_PER_PERIOD..1.5 * SEARCHED_PER_PERIOD).contains(&per_period), "{per_period}");
    }
}
