//! Projection of a recording of several joints onto problems of one joint.
//!
//! Along the measured, smoothed motion, joint i obeys
//!
//! M_ii q_i″ = τ_i − b_i(q, q′) − Σ_{j≠i} M_ij q_j″ + effects,
//!
//! where M is the mass matrix and b the bias. Everything but the effects is known there. The mean M̄ of M_ii along
//! the motion serves as inertia; (M_ii − M̄) q_i″ joins the known torques. A simulator that only integrates these
//! torques twice would drift off by the errors of the torque sensor and of the smoothing. So it is held to the
//! measured motion by a spring and a damper, as an observer is:
//!
//! M̄ θ″ + c (θ′ − q_i′) + k (θ − q_i) = known torques + effects.
//!
//! This is a driven oscillator with the drive u = known torques + c q_i′ + k q_i. Where the model lacks nothing, it
//! moves as measured; a torque that it lacks moves it by the same amount as it would move an oscillator. Errors of
//! slow torques stay as small as the spring makes them, and the error of a start state decays. Fitted
//! coefficients less those of the spring and damper are the joint's: inertia beyond M̄ is an armature, damping
//! beyond c is viscous friction, and k times the rest angle is a constant torque, such as the offset of a torque
//! sensor.
//!
//! # Reference
//! Luenberger, IEEE Transactions on Military Electronics 8 (1964) 74.

use crate::drive_noise::{Drive, Sample, drive_noise};
use crate::error::RobotError;
use crate::model::Model;
use crate::smoothing::{Smoothed, smoothed};
use crate::tracking::Tracking;

/// Damping ratio of the spring and damper that hold a simulator to the measured motion.
const DAMPING_RATIO: f64 = 0.7;

/// Shortest recording, in seconds.
const SHORTEST_S: f64 = 1.0;

/// Samples of one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Times in seconds, ascending, of the same clock for all joints.
    pub times: Vec<f64>,
    /// Positions in rad or m.
    pub positions: Vec<f64>,
    /// Torques in N m, or forces in N; `None` if they were not recorded.
    pub torques: Option<Vec<f64>>,
}

/// Recording of all joints of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Name in messages.
    pub name: String,
    /// Joints in the model's order.
    pub joints: Vec<Channel>,
}

impl Recording {
    /// Checks that every joint was recorded for a second.
    ///
    /// # Errors
    /// [`RobotError::Short`].
    pub fn check_length(&self) -> Result<(), RobotError> {
        for channel in &self.joints {
            let ends = channel.times.first().zip(channel.times.last());
            // A channel without samples lasts 0 s.
            let seconds = ends.map_or(0.0, |(first, last)| last - first);
            if seconds < SHORTEST_S {
                return Err(RobotError::Short { log: self.name.clone(), seconds });
            }
        }
        Ok(())
    }
}

/// Recording of one joint as the diagnosis of an oscillator reads it.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Index of the first sample that is used, and the number of used samples.
    pub from: usize,
    /// Drive of each used sample, in N m or N, without the offset.
    pub drive: Vec<f64>,
    /// Constant torque that acts beside the drive, in N m or N: it was added to it.
    pub offset: f64,
}

/// One joint's problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Projected {
    /// Index of the joint.
    pub joint: usize,
    /// Spring and damper that are part of the drive and of the simulator.
    pub tracking: Tracking,
    /// Two-sided spectral density of the drive's noise, in (N m)² s or N² s.
    pub drive_noise: f64,
    /// One part for each recording.
    pub parts: Vec<Part>,
}

/// Motion of all joints at the times of one of them.
struct Along {
    position: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
}

/// Returns a value between samples, linear in between.
pub(crate) fn interpolated(times: &[f64], values: &[f64], time: f64) -> Option<f64> {
    let after = times.partition_point(|own| *own < time);
    let last = times.len().checked_sub(1)?;
    let (before, after) = (after.saturating_sub(1).min(last), after.min(last));
    let (from, to) = (*times.get(before)?, *times.get(after)?);
    let (low, high) = (*values.get(before)?, *values.get(after)?);
    let share = if to > from { ((time - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
    Some(low + share * (high - low))
}

/// Smoothed recording.
pub(crate) struct Motion<'a> {
    pub(crate) recording: &'a Recording,
    pub(crate) joints: Vec<Smoothed>,
}

impl<'a> Motion<'a> {
    pub(crate) fn of(recording: &'a Recording) -> Result<Self, RobotError> {
        recording.check_length()?;
        let joints = recording.joints.iter().map(|own| smoothed(&own.times, &own.positions)).collect();
        Ok(Self { recording, joints })
    }

    /// Returns the largest number of samples on each side that a smoothed one depends on.
    pub(crate) fn width(&self) -> usize {
        // Without joints there is nothing to smooth.
        self.joints.iter().map(|own| own.half_width).max().unwrap_or(0)
    }

    /// Returns the motion of all joints at a time; `at` is the index of this time among the samples of `joint`.
    fn along(&self, joint: usize, at: usize, time: f64) -> Option<Along> {
        let mut along = Along { position: Vec::new(), velocity: Vec::new(), acceleration: Vec::new() };
        for (index, (own, channel)) in self.joints.iter().zip(&self.recording.joints).enumerate() {
            let same = index == joint || channel.times.get(at) == Some(&time);
            let value = |values: &[f64]| {
                if same { values.get(at).copied() } else { interpolated(&channel.times, values, time) }
            };
            along.position.push(value(&own.position)?);
            along.velocity.push(value(&own.velocity)?);
            along.acceleration.push(value(&own.acceleration)?);
        }
        Some(along)
    }
}

/// Torques at one sample of one joint.
struct Torques {
    time: f64,
    /// Joint's own entry of the mass matrix.
    inertia: f64,
    /// Known torques without the inertia of the joint itself.
    known: f64,
    velocity: f64,
    acceleration: f64,
    position: f64,
}

fn torques(
    model: &dyn Model,
    along: &Along,
    joint: usize,
    (time, torque): (f64, f64),
) -> Result<Torques, RobotError> {
    let short = || RobotError::Model {
        quantity: "mass matrix",
        problem: "its size is not that of the joints".into(),
    };
    let matrix = model.mass_matrix(&along.position)?;
    let bias = model.bias(&along.position, &along.velocity)?;
    let row = matrix.get(joint).ok_or_else(short)?;
    let others = row.iter().zip(&along.acceleration).enumerate().filter(|(index, _)| *index != joint);
    let others: f64 = others.map(|(_, (entry, rate))| entry * rate).sum();
    let of = |values: &[f64]| values.get(joint).copied().ok_or_else(short);
    Ok(Torques {
        time,
        inertia: of(row)?,
        known: torque - of(&bias)? - others,
        velocity: of(&along.velocity)?,
        acceleration: of(&along.acceleration)?,
        position: of(&along.position)?,
    })
}

/// Length in seconds of the stretches whose mean positions the pace is measured about: a joint that turns on and on has no
/// mean position.
const STRETCH_S: f64 = 2.0;

/// Angular frequency at which the motion of a joint goes on: the root mean square of its speeds over that of its
/// distances from its mean position along stretches. `None` if it does not move.
fn pace(samples: &[Vec<Torques>]) -> Option<f64> {
    let (mut speeds, mut distances) = (0.0, 0.0);
    for samples in samples {
        for stretch in
            samples.chunk_by(|one, next| (one.time / STRETCH_S).floor() == (next.time / STRETCH_S).floor())
        {
            let mean = stretch.iter().map(|own| own.position).sum::<f64>() / stretch.len() as f64;
            speeds += stretch.iter().map(|own| own.velocity.powi(2)).sum::<f64>();
            distances += stretch.iter().map(|own| (own.position - mean).powi(2)).sum::<f64>();
        }
    }
    (distances > 0.0 && speeds > 0.0).then(|| (speeds / distances).sqrt())
}

/// Projects recordings of a robot onto one of its joints.
///
/// # Errors
/// [`RobotError::Short`] for a recording below a second; [`RobotError::NoColumn`] without a torque of the joint;
/// [`RobotError::Still`] for a joint that does not move; [`RobotError::Model`] from the model.
pub fn project(model: &dyn Model, recordings: &[Recording], joint: usize) -> Result<Projected, RobotError> {
    // Names are for messages; a joint that is asked for is one of the model.
    let name = model.joints().get(joint).map(|own| own.name.clone()).unwrap_or_default();
    let mut samples: Vec<Vec<Torques>> = Vec::new();
    let mut from = Vec::new();
    for recording in recordings {
        let motion = Motion::of(recording)?;
        let missing = || RobotError::NoColumn {
            log: recording.name.clone(),
            quantity: "torque",
            joint: name.clone(),
            columns: "positions only".to_owned(),
            option: format!("{name}=POSITION,TORQUE"),
        };
        let channel = recording.joints.get(joint).ok_or_else(missing)?;
        let torque = channel.torques.as_ref().ok_or_else(missing)?;
        // Near the ends, cubics are one-sided and hardly know the acceleration.
        let width = motion.width();
        let used = width..channel.times.len().saturating_sub(width);
        let mut own = Vec::with_capacity(used.len());
        for at in used.clone() {
            let (Some(time), Some(torque)) = (channel.times.get(at), torque.get(at)) else { continue };
            let Some(along) = motion.along(joint, at, *time) else { continue };
            own.push(torques(model, &along, joint, (*time, *torque))?);
        }
        samples.push(own);
        from.push(used.start);
    }
    let count = samples.iter().map(Vec::len).sum::<usize>().max(1) as f64;
    let inertia = samples.iter().flatten().map(|own| own.inertia).sum::<f64>() / count;
    let pace = pace(&samples).ok_or(RobotError::Still { joint: name })?;
    let tracking =
        Tracking { inertia, damping: 2.0 * DAMPING_RATIO * inertia * pace, stiffness: inertia * pace * pace };
    let drive = |own: &Torques| {
        own.known - (own.inertia - inertia) * own.acceleration
            + tracking.damping * own.velocity
            + tracking.stiffness * own.position
    };
    let sample = |own: &Torques| Sample {
        time: own.time,
        position: own.position,
        velocity: own.velocity,
        acceleration: own.acceleration,
        unexplained: own.inertia * own.acceleration - own.known,
    };
    let known: Vec<Vec<Sample>> = samples.iter().map(|own| own.iter().map(sample).collect()).collect();
    let turns = model.joints().get(joint).is_some_and(|own| !own.slides);
    let Drive { density, offsets } = drive_noise(&tracking, &known, turns);
    let parts = samples.iter().zip(from).zip(offsets).map(|((samples, from), offset)| Part {
        from,
        drive: samples.iter().map(|own| drive(own) + offset).collect(),
        offset,
    });
    Ok(Projected { joint, tracking, drive_noise: density, parts: parts.collect() })
}
