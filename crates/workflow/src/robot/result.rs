//! Results of a robot's diagnosis, and its repaired model.

use super::identifiable::identifiable;
use super::joint::JointAnswer;
use super::read::RobotQuestion;
use results::{
    ClosedLoopRow, FailedCase, JOINTS_SCHEMA, JointErrorRow, JointRow, JointsResult, RecordingRow,
    WithInterval,
};
use robot::{JointRepair, RepairedModel, RobotError};

/// Smallest part of a joint's inertia that an armature is worth a remark for.
const NOTED: f64 = 1e-3;

impl RobotQuestion {
    /// Collects the answers of the joints and the check of the whole model; `notes` are remarks of the caller.
    #[must_use]
    pub fn result(
        &self,
        answers: &[JointAnswer],
        failed: Vec<FailedCase>,
        closed_loop: Option<ClosedLoopRow>,
        (notes, seconds): (Vec<String>, f64),
    ) -> JointsResult {
        let error = |name: &str| {
            let at = self.model.joints().iter().position(|joint| joint.name == name)?;
            pooled(closed_loop.as_ref()?, at)
        };
        let joints = answers.iter().map(|own| JointRow {
            name: own.joint.name.clone(),
            diagnosis: own.answer.result.clone(),
            tracking: own.tracking.clone(),
            repair: own.repair.clone(),
            closed_loop: error(&own.joint.name),
        });
        let differences = self.differences();
        let recordings = self.recordings.iter().zip(differences).filter_map(|(own, differs_in)| {
            let first = own.joints.first()?;
            let channel = own.along.recording().joints.first()?;
            let (from, to) = channel.times.first().zip(channel.times.last())?;
            Some(RecordingRow {
                path: own.along.recording().name.clone(),
                digest: first.source.digest.clone(),
                duration_s: to - from,
                samples: channel.times.len(),
                fitted: own.fitted,
                agrees: differs_in.is_empty(),
                differs_in,
            })
        });
        JointsResult {
            schema: JOINTS_SCHEMA.to_owned(),
            model: self.name.clone(),
            joints: joints.collect(),
            failed,
            identifiable: answers.iter().flat_map(identifiable).collect(),
            recordings: recordings.collect(),
            closed_loop,
            notes,
            seconds,
        }
    }

    /// Returns the model's file with the numbers of its joints as found; `None` for a model that is no file.
    ///
    /// # Errors
    /// [`RobotError`] from a model that writes itself.
    pub fn repaired(&self, answers: &[JointAnswer]) -> Result<Option<RepairedModel>, RobotError> {
        let of = |joint: &robot::JointInfo| {
            let answer = answers.iter().find(|own| own.joint.name == joint.name);
            answer.map_or_else(JointRepair::default, |own| repair(own, self.model.format()))
        };
        let repairs: Vec<JointRepair> = self.model.joints().iter().map(of).collect();
        self.model.repaired(&repairs)
    }
}

/// Returns the errors of all recordings at one joint; `None` if some variant has none anywhere.
fn pooled(closed_loop: &ClosedLoopRow, joint: usize) -> Option<JointErrorRow> {
    let rows: Vec<(&JointErrorRow, usize)> =
        closed_loop.recordings.iter().filter_map(|own| Some((own.joints.get(joint)?, own.runs))).collect();
    let first = rows.first()?.0;
    let over = |of: fn(&JointErrorRow) -> Option<f64>| {
        let squares: Option<f64> =
            rows.iter().map(|(row, runs)| of(row).map(|own| own * own * *runs as f64)).sum();
        let runs: usize = rows.iter().map(|(_, runs)| runs).sum();
        squares.map(|squares| (squares / runs.max(1) as f64).sqrt())
    };
    Some(JointErrorRow {
        unit: first.unit.clone(),
        nominal: over(|row| row.nominal),
        recalibrated: over(|row| row.recalibrated),
        repaired: over(|row| row.repaired),
        noise_floor: first.noise_floor,
    })
}

/// Returns `true` for a number that is not 0 by its interval.
fn excludes_zero(own: &WithInterval) -> bool {
    own.interval_95[0] * own.interval_95[1] > 0.0
}

/// Returns the numbers and remarks of one joint for a file of a format: those that the whole model was run with.
fn repair(own: &JointAnswer, format: &str) -> JointRepair {
    let (turns, torque) = if own.joint.slides { ("kg", "N") } else { ("kg m^2", "N m") };
    let significant = |value: f64| format!("{value:.4e}").parse::<f64>().unwrap_or(value);
    let mut remarks = Vec::new();
    let mut friction = None;
    let [.., run] = &own.acting;
    for active in &run.effects {
        match active.id() {
            "coulomb_friction" => friction = active.value("torque").map(significant),
            "constant_torque" => {}
            id => {
                let values = active.effect().description().parameters.iter().zip(active.values());
                let values: Vec<String> =
                    values.map(|(own, value)| format!("{} {}", own.name, significant(*value))).collect();
                remarks.push(format!("{format} cannot hold {id} ({}).", values.join(", ")));
            }
        }
    }
    let damping = own.repair.damping.map(|_| significant(run.damping));
    let held = own.joint.armature.map(|known| significant(known + run.inertia));
    let noted = |found: &WithInterval| held.is_none() && found.value.abs() > NOTED * own.tracking.inertia;
    if let Some(armature) = own.repair.armature.filter(noted) {
        remarks.push(format!(
            "{format} cannot hold an armature of {} {turns} (95 % interval {} to {}).",
            significant(armature.value),
            significant(armature.interval_95[0]),
            significant(armature.interval_95[1])
        ));
    }
    let spring = own.joint.stiffness.map(|known| significant(known + run.stiffness));
    if let Some(found) = own.repair.stiffness.filter(|found| spring.is_none() && excludes_zero(found)) {
        let unit = if own.joint.slides { "N/m" } else { "N m/rad" };
        remarks.push(format!(
            "{format} does not hold the spring of {} {unit} about 0 that the fit found.",
            significant(found.value)
        ));
    }
    if let Some(offset) = own.repair.torque_offset.filter(excludes_zero) {
        remarks.push(format!(
            "The torque sensor is off by {} {torque}, or a constant torque of that size acts.",
            significant(offset.value)
        ));
    }
    if let Some(gain) = own.repair.torque_gain {
        remarks.push(format!(
            "The torque is {} times what its sensor reads (95 % interval {} to {}).",
            significant(gain.value),
            significant(gain.interval_95[0]),
            significant(gain.interval_95[1])
        ));
    }
    JointRepair { damping, friction, armature: held, stiffness: spring, remarks }
}
