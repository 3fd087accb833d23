//! Motion of all joints of a recording, smoothed, with the mass matrix and the bias forces along it.
//!
//! This is all that the projection needs from a model, so that a simulator of the user's is asked once for each sample.

use crate::error::RobotError;
use crate::model::Model;
use crate::recording::Recording;
use crate::smoothing::{Smoothed, smoothed};
use dynamics::tree::State;

/// Motion of all joints at one time, with what the model says there.
pub(crate) struct Moment {
    pub(crate) position: Vec<f64>,
    pub(crate) velocity: Vec<f64>,
    pub(crate) acceleration: Vec<f64>,
    /// Row of the mass matrix that belongs to the joint that was asked for.
    pub(crate) inertia: Vec<f64>,
    /// Bias force of that joint.
    pub(crate) bias: f64,
}

/// Recording with its smoothed motion and the model along it.
#[derive(Debug, Clone, PartialEq)]
pub struct Along {
    recording: Recording,
    joints: Vec<Smoothed>,
    /// Mass matrix and bias forces at the times of the first joint.
    mass: Vec<Vec<Vec<f64>>>,
    bias: Vec<Vec<f64>>,
}

/// Returns a value between samples, linear in between.
pub(crate) fn interpolated(times: &[f64], values: &[f64], time: f64) -> Option<f64> {
    let (before, after, share) = beside(times, time)?;
    let (low, high) = (*values.get(before)?, *values.get(after)?);
    Some(low + share * (high - low))
}

/// Returns the indices of the samples about a time, and its share of the way from the first to the second.
fn beside(times: &[f64], time: f64) -> Option<(usize, usize, f64)> {
    let after = times.partition_point(|own| *own < time);
    let last = times.len().checked_sub(1)?;
    let (before, after) = (after.saturating_sub(1).min(last), after.min(last));
    let (from, to) = (*times.get(before)?, *times.get(after)?);
    let share = if to > from { ((time - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
    Some((before, after, share))
}

fn mixed(from: &[f64], to: &[f64], share: f64) -> Vec<f64> {
    from.iter().zip(to).map(|(from, to)| from + share * (to - from)).collect()
}

impl Along {
    /// Smooths a recording and evaluates the model along its motion, at the times of the first joint.
    ///
    /// # Errors
    /// [`RobotError::Short`] for a recording below a second; [`RobotError::Model`] from the model, also if its matrix or
    /// vector has not the size of the joints.
    pub fn of(model: &dyn Model, recording: Recording) -> Result<Self, RobotError> {
        recording.check_length()?;
        let joints: Vec<Smoothed> =
            recording.joints.iter().map(|own| smoothed(&own.times, &own.positions)).collect();
        let times = recording.joints.first().map_or(&[][..], |own| own.times.as_slice());
        let at = |of: fn(&Smoothed) -> &Vec<f64>, index: usize, time: f64| -> Vec<f64> {
            let each = joints.iter().zip(&recording.joints);
            let value = |(own, channel): (&Smoothed, &crate::recording::Channel)| {
                let same = channel.times.get(index) == Some(&time);
                let direct = of(own).get(index).copied().filter(|_| same);
                direct.or_else(|| interpolated(&channel.times, of(own), time))
            };
            each.filter_map(value).collect()
        };
        let states: Vec<State> = times
            .iter()
            .enumerate()
            .map(|(index, time)| State {
                position: at(|own| &own.position, index, *time),
                velocity: at(|own| &own.velocity, index, *time),
            })
            .collect();
        let (mass, bias) = model.along(&states)?;
        let count = recording.joints.len();
        let square = |own: &Vec<Vec<f64>>| own.len() == count && own.iter().all(|row| row.len() == count);
        let wrong = |quantity| RobotError::Model {
            quantity,
            problem: format!("it has not the size of the {count} joints, at every sample"),
        };
        if mass.len() != states.len() || !mass.iter().all(square) {
            return Err(wrong("mass matrix"));
        }
        if bias.len() != states.len() || bias.iter().any(|own| own.len() != count) {
            return Err(wrong("bias forces"));
        }
        let finite = |own: &[f64]| own.iter().all(|value| value.is_finite());
        let no_number = |quantity| RobotError::Model {
            quantity,
            problem: "it holds a value that is no finite number".to_owned(),
        };
        if !mass.iter().flatten().all(|row| finite(row)) {
            return Err(no_number("mass matrix"));
        }
        if !bias.iter().all(|own| finite(own)) {
            return Err(no_number("bias forces"));
        }
        Ok(Self { recording, joints, mass, bias })
    }

    /// Returns the recording.
    #[must_use]
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// Returns the largest number of samples on each side that a smoothed one depends on.
    pub(crate) fn width(&self) -> usize {
        self.joints.iter().map(|own| own.half_width).fold(0, usize::max)
    }

    /// Returns the motion of all joints at sample `at` of `joint`, which is at `time`.
    pub(crate) fn moment(&self, joint: usize, at: usize, time: f64) -> Option<Moment> {
        let (mut position, mut velocity, mut acceleration) = (Vec::new(), Vec::new(), Vec::new());
        for (index, (own, channel)) in self.joints.iter().zip(&self.recording.joints).enumerate() {
            let same = index == joint || channel.times.get(at) == Some(&time);
            let value = |values: &[f64]| {
                if same { values.get(at).copied() } else { interpolated(&channel.times, values, time) }
            };
            position.push(value(&own.position)?);
            velocity.push(value(&own.velocity)?);
            acceleration.push(value(&own.acceleration)?);
        }
        let (before, after, share) = beside(&self.recording.joints.first()?.times, time)?;
        let row = |at: usize| self.mass.get(at)?.get(joint);
        let own = |at: usize| self.bias.get(at)?.get(joint);
        let (low, high) = (*own(before)?, *own(after)?);
        let inertia = mixed(row(before)?, row(after)?, share);
        Some(Moment { position, velocity, acceleration, inertia, bias: low + share * (high - low) })
    }

    /// Returns the smoothed state of all joints at a time.
    #[must_use]
    pub fn state(&self, time: f64) -> State {
        let joints = self.joints.iter().zip(&self.recording.joints);
        let of = |(own, channel): (&Smoothed, &crate::recording::Channel)| {
            let at = |values: &[f64]| interpolated(&channel.times, values, time);
            Some((at(&own.position)?, at(&own.velocity)?))
        };
        let (position, velocity) = joints.filter_map(of).unzip();
        State { position, velocity }
    }
}
