//! Closed loop: the whole model, run under the recorded torques from measured states.

use crate::along::{Along, interpolated};
use crate::error::RobotError;
use crate::model::{JointInfo, Model};
use crate::recording::Recording;
use dynamics::Hold;
use dynamics::tree::{Acting, State, TreeError};
use rayon::prelude::*;
use std::ops::Range;

/// Errors of a model at one joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointError {
    /// Sum of the squared differences of positions, in rad² or m².
    pub squares: f64,
    /// Number of samples.
    pub samples: usize,
}

impl JointError {
    /// Returns the root mean square; `None` without samples.
    #[must_use]
    pub fn rms(&self) -> Option<f64> {
        (self.samples > 0).then(|| (self.squares / self.samples as f64).sqrt())
    }
}

/// Errors of one variant of a model on a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedLoop {
    /// Errors by joint; `None` if a motion left every bound.
    pub joints: Option<Vec<JointError>>,
    /// Number of runs.
    pub runs: usize,
    /// Times in seconds at which they start, and the states there.
    pub starts: Vec<(f64, State)>,
}

/// Times and torques of one joint, as values that change linearly.
type Torques<'a> = (&'a [f64], Vec<f64>);

/// Returns times and torques of every joint.
fn torques<'a>(
    recording: &'a Recording,
    joints: &[JointInfo],
    holds: &[Hold],
    gains: &[f64],
) -> Result<Vec<Torques<'a>>, RobotError> {
    let mut torques = Vec::new();
    for (((channel, joint), hold), gain) in recording.joints.iter().zip(joints).zip(holds).zip(gains) {
        let mut own = channel.linear_torques(*hold).ok_or_else(|| RobotError::NoColumn {
            log: recording.name.clone(),
            quantity: "torque",
            joint: joint.name.clone(),
            columns: "positions only".to_owned(),
            option: format!("{}=POSITION,TORQUE", joint.name),
        })?;
        own.iter_mut().for_each(|torque| *torque *= gain);
        torques.push((channel.times.as_slice(), own));
    }
    Ok(torques)
}

/// Torques that act in the joints of a variant of a model, and the behavior of each drive between samples.
#[derive(Debug, Clone, Copy)]
pub struct Variant<'a> {
    /// Torques beside the drive, by joint.
    pub acting: &'a [Acting],
    /// Behavior of the drive's torque between samples, by joint.
    pub holds: &'a [Hold],
    /// Torque of each drive over what its sensor reads, by joint.
    pub gains: &'a [f64],
}

/// Runs a model with what acts in its joints over a recording, in runs of `span` seconds from the measured state, and
/// compares the positions. Only the part of the recording between two shares of its length is used.
///
/// # Errors
/// [`RobotError::NoColumn`] if a torque was not recorded; [`RobotError::Model`] and [`RobotError::Motion`] from the model.
pub fn closed_loop(
    model: &dyn Model,
    Variant { acting, holds, gains }: Variant<'_>,
    along: &Along,
    (span, part): (f64, Range<f64>),
) -> Result<ClosedLoop, RobotError> {
    let recording = along.recording();
    let torques = torques(recording, model.joints(), holds, gains)?;
    let Some(first) = recording.joints.first() else {
        return Ok(ClosedLoop { joints: None, runs: 0, starts: Vec::new() });
    };
    let times = used(&first.times, along.width(), part);
    let run = |times: &&[f64]| -> Result<Option<Vec<JointError>>, RobotError> {
        let Some(begin) = times.first() else { return Ok(None) };
        let drive = |time: &f64| -> Vec<f64> {
            torques.iter().filter_map(|(times, own)| interpolated(times, own, *time)).collect()
        };
        let inputs: Vec<Vec<f64>> = times.iter().map(drive).collect();
        match model.rollout(acting, &along.state(*begin), times, &inputs) {
            Ok(path) => Ok(Some(errors(recording, times, &path))),
            Err(RobotError::Motion(TreeError::Diverged { .. } | TreeError::NoInertia { .. })) => Ok(None),
            Err(error) => Err(error),
        }
    };
    let spans = in_runs(times, span);
    let found: Vec<Option<Vec<JointError>>> = spans.par_iter().map(run).collect::<Result<_, _>>()?;
    // The first run that leaves every bound is the last one.
    let runs = found.iter().take_while(|own| own.is_some()).count();
    let begins = spans.iter().take(runs + 1).filter_map(|own| own.first());
    let starts = begins.map(|begin| (*begin, along.state(*begin))).collect();
    let mut sums = vec![JointError::default(); model.joints().len()];
    for own in found.iter().flatten() {
        for (sum, own) in sums.iter_mut().zip(own) {
            sum.squares += own.squares;
            sum.samples += own.samples;
        }
    }
    Ok(ClosedLoop { joints: (runs == found.len()).then_some(sums), runs, starts })
}

/// Returns the times of a recording between two shares of its length, without `width` samples at either end.
fn used(times: &[f64], width: usize, part: Range<f64>) -> &[f64] {
    let count = times.len();
    let from = ((part.start * count as f64) as usize).max(width);
    let to = ((part.end * count as f64) as usize).min(count.saturating_sub(width));
    times.get(from..to).unwrap_or_default()
}

/// Returns times in runs of `span` seconds. A rest that is shorter than half a run is left out beside others: it would weigh its
/// first moments twice.
fn in_runs(mut times: &[f64], span: f64) -> Vec<&[f64]> {
    let mut runs = Vec::new();
    while let (Some(begin), true) = (times.first(), times.len() > 1) {
        let (run, rest) = times.split_at(times.partition_point(|time| *time <= begin + span));
        if !runs.is_empty() && run.last().is_none_or(|last| last - begin < 0.5 * span) || run.len() < 2 {
            break;
        }
        runs.push(run);
        times = rest;
    }
    runs
}

/// Compares positions along a run with those of a recording.
fn errors(recording: &Recording, times: &[f64], path: &[Vec<f64>]) -> Vec<JointError> {
    let mut errors = vec![JointError::default(); recording.joints.len()];
    for (time, position) in times.iter().zip(path) {
        for ((error, channel), own) in errors.iter_mut().zip(&recording.joints).zip(position) {
            let Some(measured) = interpolated(&channel.times, &channel.positions, *time) else { continue };
            error.squares += (own - measured).powi(2);
            error.samples += 1;
        }
    }
    errors
}
