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
//! The drive is computed for torques that keep their last sample and for torques that change linearly; the behavior that leaves
//! less unexplained is taken. Half a sampling interval of delay would pass for a damping of −M_ii ω² times as much.
//!
//! # Reference
//! Luenberger, IEEE Transactions on Military Electronics 8 (1964) 74.

use crate::along::Along;
use crate::drive_noise::{Drive, Gain, Sample, drive_noise};
use crate::error::RobotError;
use crate::model::JointInfo;
use crate::tracking::Tracking;
use dynamics::Hold;

/// Damping ratio of the spring and damper that hold a simulator to the measured motion.
const DAMPING_RATIO: f64 = 0.7;

/// Behaviors of the drive's torque between samples that are told apart: a controller keeps its last output, a sensor's torque
/// changes in between.
const HOLDS: [Hold; 2] = [Hold::Zero, Hold::Linear];

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

/// Size of a joint's motion, which says what its recordings can tell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Root mean square of the drive's torque about its mean, in N m or N.
    pub torque: f64,
    /// Root mean square of the speed, per second.
    pub speed: f64,
    /// Share of the squares of dry friction's motion that an armature, a spring and smooth damping do not imitate.
    pub friction_alone: f64,
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
    /// Size of the motion.
    pub scale: Scale,
    /// Behavior of the torque between samples that leaves less unexplained.
    pub hold: Hold,
    /// Gain of the torque sensor, by which the recorded torques were multiplied; `None` if it is not told from 1.
    pub gain: Option<Gain>,
    /// One part for each recording.
    pub parts: Vec<Part>,
}

/// Torques at one sample of one joint.
struct Torques {
    time: f64,
    /// Joint's own entry of the mass matrix.
    inertia: f64,
    /// Torque that the model needs beside the inertia of the joint itself.
    model: f64,
    /// Torque of the drive, by [`HOLDS`].
    drives: [f64; 2],
    velocity: f64,
    acceleration: f64,
    position: f64,
}

impl Torques {
    /// Returns the torque of the drive.
    fn drive(&self, hold: Hold) -> f64 {
        let [held, linear] = self.drives;
        if hold == Hold::Zero { held } else { linear }
    }
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

/// Returns the torques at the samples of a joint in the first `share` of a recording, and the index of the first one.
fn torques(along: &Along, joint: usize, share: f64) -> Option<(usize, Vec<Torques>)> {
    let channel = along.recording().joints.get(joint)?;
    let drives = HOLDS.map(|hold| channel.linear_torques(hold));
    let [held, linear] = &drives;
    let (held, linear) = (held.as_ref()?, linear.as_ref()?);
    // Near the ends, polynomials are one-sided and hardly know the acceleration; those near the end of the share depend on
    // samples beyond it.
    let width = along.width();
    let count = (share * channel.times.len() as f64).round() as usize;
    let used = width..count.saturating_sub(width);
    let mut own = Vec::with_capacity(used.len());
    for at in used.clone() {
        let time = *channel.times.get(at)?;
        let moment = along.moment(joint, at, time)?;
        let others = moment.inertia.iter().zip(&moment.acceleration).enumerate();
        let others = others.filter(|(index, _)| *index != joint).map(|(_, (entry, rate))| entry * rate);
        own.push(Torques {
            time,
            inertia: *moment.inertia.get(joint)?,
            model: moment.bias + others.sum::<f64>(),
            drives: [*held.get(at)?, *linear.get(at)?],
            velocity: *moment.velocity.get(joint)?,
            acceleration: *moment.acceleration.get(joint)?,
            position: *moment.position.get(joint)?,
        });
    }
    Some((used.start, own))
}

/// Samples of one joint in all recordings, with the oscillator that holds its simulator to them.
pub(crate) struct Gathered {
    samples: Vec<Vec<Torques>>,
    /// Index of the first sample that is used, by recording.
    from: Vec<usize>,
    pub(crate) tracking: Tracking,
    pub(crate) turns: bool,
}

impl Gathered {
    /// Gathers the samples of a joint in the first `share` of each recording.
    pub(crate) fn of(
        joints: &[JointInfo],
        recordings: &[&Along],
        joint: usize,
        share: f64,
    ) -> Result<Self, RobotError> {
        // Names are for messages; a joint that is asked for is one of the model.
        let name = joints.get(joint).map(|own| own.name.clone()).unwrap_or_default();
        let (mut samples, mut from) = (Vec::new(), Vec::new());
        for along in recordings {
            let (first, own) = torques(along, joint, share).ok_or_else(|| RobotError::NoColumn {
                log: along.recording().name.clone(),
                quantity: "torque",
                joint: name.clone(),
                columns: "positions only".to_owned(),
                option: format!("{name}=POSITION,TORQUE"),
            })?;
            samples.push(own);
            from.push(first);
        }
        let count = samples.iter().map(Vec::len).sum::<usize>().max(1) as f64;
        let inertia = samples.iter().flatten().map(|own| own.inertia).sum::<f64>() / count;
        let pace = pace(&samples).ok_or(RobotError::Still { joint: name })?;
        let (damping, stiffness) = (2.0 * DAMPING_RATIO * inertia * pace, inertia * pace * pace);
        let turns = joints.get(joint).is_some_and(|own| !own.slides);
        Ok(Self { samples, from, tracking: Tracking { inertia, damping, stiffness }, turns })
    }

    /// Returns the motion with the torques that the model leaves unexplained, by recording.
    fn unexplained(&self, hold: Hold) -> Vec<Vec<Sample>> {
        let sample = |own: &Torques| Sample {
            time: own.time,
            position: own.position,
            velocity: own.velocity,
            acceleration: own.acceleration,
            unexplained: own.inertia * own.acceleration + own.model - own.drive(hold),
            torque: own.drive(hold),
        };
        self.samples.iter().map(|own| own.iter().map(sample).collect()).collect()
    }

    /// Returns the behavior of the torque between samples that leaves less, the samples under it, and what is left.
    pub(crate) fn best(&self) -> (Hold, Vec<Vec<Sample>>, Drive) {
        let [held, linear] = HOLDS.map(|hold| {
            let mut samples = self.unexplained(hold);
            let drive = drive_noise(&self.tracking, &samples, self.turns);
            let excess = drive.gain.map_or(0.0, |gain| gain.value - 1.0);
            samples.iter_mut().flatten().for_each(|own| own.unexplained -= excess * own.torque);
            (hold, samples, drive)
        });
        if held.2.density < linear.2.density { held } else { linear }
    }

    /// Returns the root mean square of a quantity about its mean.
    fn root(&self, of: impl Fn(&Torques) -> f64) -> f64 {
        let all = || self.samples.iter().flatten().map(&of);
        let count = all().count().max(1) as f64;
        let mean = all().sum::<f64>() / count;
        (all().map(|own| (own - mean).powi(2)).sum::<f64>() / count).sqrt()
    }
}

/// Projects recordings of a robot, or the first `share` of each, onto one of its joints.
///
/// # Errors
/// [`RobotError::NoColumn`] without a torque of the joint; [`RobotError::Still`] for a joint that does not move.
pub fn project(
    joints: &[JointInfo],
    recordings: &[&Along],
    joint: usize,
    share: f64,
) -> Result<Projected, RobotError> {
    let gathered = Gathered::of(joints, recordings, joint, share)?;
    let (hold, _, Drive { density, offsets, friction_alone, gain }) = gathered.best();
    let tracking = gathered.tracking;
    let times = gain.map_or(1.0, |gain| gain.value);
    let drive = |own: &Torques| {
        times * own.drive(hold) - own.model - (own.inertia - tracking.inertia) * own.acceleration
            + tracking.damping * own.velocity
            + tracking.stiffness * own.position
    };
    let scale = Scale {
        torque: gathered.root(|own| own.drives[1]),
        speed: gathered.root(|own| own.velocity),
        friction_alone,
    };
    let parts = gathered.samples.iter().zip(&gathered.from).zip(offsets).map(|((samples, from), offset)| {
        Part { from: *from, drive: samples.iter().map(|own| drive(own) + offset).collect(), offset }
    });
    Ok(Projected { joint, tracking, drive_noise: density, scale, hold, gain, parts: parts.collect() })
}
