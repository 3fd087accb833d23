//! Choice of the experiment that best separates two explanations.

#![allow(
    clippy::indexing_slicing,
    reason = "a fit has a start state of at least two entries for every segment; `cut` makes at least one"
)]

use crate::answer::Experiment;
use crate::data::segments::{Data, Segment};
use crate::fit::fitted::{Fit, Point};
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use crate::model::predictor::{Derivatives, Simulator};
use dynamics::{DynamicsError, Input};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Further record beside the present data.
struct Plan {
    text: &'static str,
    /// Deflection at the start of the new record relative to the present one's.
    release: f64,
    /// Length relative to the present one's.
    length: f64,
    /// Input relative to the present one's.
    drive: f64,
    /// Angle by which the mount is turned, in radians.
    tilt: f64,
}

const fn plan(text: &'static str, release: f64, length: f64, drive: f64, tilt: f64) -> Plan {
    Plan { text, release, length, drive, tilt }
}

const FREE: [Plan; 4] = [
    plan("release once more from twice the amplitude", 2.0, 1.0, 1.0, 0.0),
    plan("release once more from a quarter of the amplitude", 0.25, 1.0, 1.0, 0.0),
    plan("record a release for twice as long", 1.0, 2.0, 1.0, 0.0),
    plan("turn the mount by 90 degrees and release once more", 1.0, 1.0, 1.0, FRAC_PI_2),
];

const DRIVEN: [Plan; 2] = [
    plan("drive once more with twice the input", 1.0, 1.0, 2.0, 0.0),
    plan("drive once more with half the input", 1.0, 1.0, 0.5, 0.0),
];

/// Largest release angle, in radians; beyond it a spring or a stop may behave differently.
const FARTHEST: f64 = 0.75 * PI;

/// Returns the global parameters of a fit with its weights turned by an angle.
fn turned(data: &Data, model: &Fit, tilt: f64) -> Vec<f64> {
    let mut point = model.point.globals.clone();
    let calibrated = model.hypothesis.calibrated.len();
    let mut at = calibrated;
    for candidate in &model.hypothesis.candidates {
        if candidate.is_weight()
            && let Some([p, q]) = point.get_mut(at..at + 2)
        {
            // The pair (size·cos, size·sin) turns with the mount.
            let (sine, cosine) = libm::sincos(tilt);
            (*p, *q) = (*p * cosine - *q * sine, *p * sine + *q * cosine);
        }
        at += candidate.parameters(&data.facts).len();
    }
    point
}

/// Returns the present segments with the noiseless values that `model` predicts.
fn noiseless(data: &Data, model: &Fit) -> Result<Vec<Segment>, DynamicsError> {
    let mut segments = data.segments.clone();
    let mut now = Simulator::new(data, &model.hypothesis, &model.point.globals, Derivatives::None)?;
    for (segment, start) in segments.iter_mut().zip(&model.point.starts) {
        let residual = now.predict(segment, start)?.residual;
        for (value, residual) in segment.values.iter_mut().zip(residual.iter()) {
            *value -= residual;
        }
    }
    Ok(segments)
}

/// Returns noiseless data as `model` predicts them: the present segments, and those of a further record.
fn synthetic(data: &Data, model: &Fit, plan: &Plan) -> Result<(Data, Point), DynamicsError> {
    let (mut segments, mut starts) = (noiseless(data, model)?, model.point.starts.clone());
    let record = data.inputs.len();
    let mut inputs = data.inputs.clone();
    let driven = |input: &Input| input.scaled(plan.drive);
    inputs.push(data.inputs.first().and_then(Option::as_ref).map(driven).transpose()?);
    let planned = Data { inputs, ..data.clone() };
    let point = turned(data, model, plan.tilt);
    let mut then = Simulator::new(&planned, &model.hypothesis, &point, Derivatives::None)?;
    let rest = data.facts.rest(&model.point.globals, &model.hypothesis);
    let own: Vec<&Segment> = data.segments.iter().filter(|segment| segment.record == 0).collect();
    let mut state = model.point.starts[0].clone();
    state[0] = rest + plan.release * (state[0] - rest);
    let repeats = plan.length.ceil() as usize;
    let mut offset = 0.0;
    for _ in 0..repeats {
        for (index, segment) in own.iter().enumerate() {
            let times: Vec<f64> = segment.times.iter().map(|time| time + offset).collect();
            let end = own.get(index + 1).and_then(|next| next.times.first()).map(|time| time + offset);
            let next = end.unwrap_or_else(|| times.last().copied().unwrap_or(offset) + data.facts.interval);
            let mut fresh = Segment {
                record,
                first: index == 0 && offset == 0.0,
                values: vec![0.0; times.len()],
                still: false,
                times,
                parts: segment.parts.clone(),
                guess: [0.0; 2],
                stretch: 0,
            };
            let predicted = then.predict(&fresh, &state)?.residual;
            fresh.values = predicted.iter().map(|residual| -residual).collect();
            let bridge = Segment {
                times: vec![fresh.times.first().copied().unwrap_or(offset), next],
                values: vec![0.0; 2],
                ..fresh.clone()
            };
            starts.push(state.clone());
            state = then.end(&bridge, &state)?;
            segments.push(fresh);
        }
        offset += data.facts.duration + data.facts.interval;
    }
    Ok((Data { segments, ..planned }, Point { globals: Vec::new(), starts }))
}

/// Fits the rival to what the model predicts for the present experiment and a further one, and returns the
/// distance that remains between them, in units of the noise.
fn distance(data: &Data, model: &Fit, rival: &Fit, plan: &Plan, noise: f64) -> Option<f64> {
    let (future, made) = synthetic(data, model, plan).ok()?;
    let length = rival.hypothesis.start_length();
    let starts = made.starts.iter().map(|start| start.iter().copied().cycle().take(length).collect());
    let point = Point { globals: rival.point.globals.clone(), starts: starts.collect() };
    // With a turned mount the rival's own gravity turns too; it is the same law only if both have one.
    let fitted = fit(&future, &rival.hypothesis, point, Moving::All, Stopping::PLANNED).ok()?;
    Some(fitted.squares.sqrt() / noise)
}

/// Returns the experiment with the largest distance between a model and its rival. `noise` is that of the
/// data's samples (for strided data, divided by the square root of the stride).
pub(crate) fn next(data: &Data, model: &Fit, rival: &Fit, noise: f64) -> Option<Experiment> {
    let driven = data.driven();
    let has = |fit: &Fit| fit.hypothesis.candidates.iter().any(|own| own.is_weight());
    let plans: &[Plan] = if driven { &DRIVEN } else { &FREE };
    let usable = plans.iter().filter(|plan| {
        let farther = plan.release <= 1.0 || plan.release * data.facts.amplitude <= FARTHEST;
        farther && (plan.tilt == 0.0 || has(model) != has(rival))
    });
    let usable: Vec<&Plan> = usable.collect();
    let considered: Vec<(String, f64)> = usable
        .into_par_iter()
        .filter_map(|plan| {
            // A model without gravity predicts no effect of the turn, so the one that has it makes the data.
            let (from, to) = if plan.tilt != 0.0 && has(rival) { (rival, model) } else { (model, rival) };
            Some((plan.text.to_owned(), distance(data, from, to, plan, noise)?))
        })
        .collect();
    let (text, distance) = considered.iter().max_by(|a, b| a.1.total_cmp(&b.1)).cloned()?;
    let only = |own: &Fit, other: &Fit| -> Option<&'static str> {
        let mut ids = own.hypothesis.candidates.iter().filter(|c| !other.hypothesis.candidates.contains(c));
        ids.next().map(|candidate| candidate.id())
    };
    let separates = [only(model, rival), only(rival, model)].into_iter().flatten().collect();
    Some(Experiment { text, separates, distance, considered })
}
