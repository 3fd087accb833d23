//! Results of a robot's diagnosis, and its repaired model.

use super::joint::JointAnswer;
use super::read::RobotQuestion;
use results::{
    ClosedLoopRow, FailedCase, IdentifiableRow, JOINTS_SCHEMA, JointErrorRow, JointRow, JointsResult,
    RecordingRow, WithInterval,
};
use robot::{JointRepair, Model, repaired};

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
        let recordings = self.recordings.iter().filter_map(|own| {
            let first = own.joints.first()?;
            let channel = own.recording.joints.first()?;
            let (from, to) = channel.times.first().zip(channel.times.last())?;
            Some(RecordingRow {
                path: own.recording.name.clone(),
                digest: first.source.digest.clone(),
                duration_s: to - from,
                samples: channel.times.len(),
                fitted: own.fitted,
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

    /// Returns the model as URDF with damping and friction as found.
    #[must_use]
    pub fn repaired_urdf(&self, answers: &[JointAnswer]) -> String {
        let of = |joint: &robot::JointInfo| {
            let answer = answers.iter().find(|own| own.joint.name == joint.name);
            answer.map_or_else(JointRepair::default, repair)
        };
        let repairs: Vec<JointRepair> = self.model.joints().iter().map(of).collect();
        repaired(&self.model, &repairs)
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

fn is_told(own: &Option<WithInterval>) -> bool {
    own.is_some_and(|own| own.interval_95.iter().all(|end| end.is_finite()))
}

/// Lists what the recordings tell of a joint beside the effects.
fn identifiable(own: &JointAnswer) -> Vec<IdentifiableRow> {
    let rows = [
        ("armature", &own.repair.armature, "motion of this joint in fast and in slow turns"),
        ("damping", &own.repair.damping, "motion of this joint at two speeds or more"),
        (
            "torque_offset",
            &own.repair.torque_offset,
            "motion of this joint in both directions, several times",
        ),
    ];
    let row = |(quantity, found, record): (&str, &Option<WithInterval>, &str)| {
        let told = is_told(found);
        IdentifiableRow {
            quantity: quantity.to_owned(),
            joint: own.joint.name.clone(),
            told,
            record: if told { String::new() } else { record.to_owned() },
        }
    };
    rows.into_iter().map(row).collect()
}

/// Returns the numbers and remarks of one joint for the URDF.
fn repair(own: &JointAnswer) -> JointRepair {
    let (turns, torque) = if own.joint.slides { ("kg", "N") } else { ("kg m^2", "N m") };
    let significant = |value: f64| format!("{value:.4e}").parse::<f64>().unwrap_or(value);
    let mut remarks = Vec::new();
    let mut friction = None;
    for active in own.answer.repaired.system.effects() {
        match active.id() {
            "coulomb_friction" => friction = active.value("torque").map(significant),
            "constant_torque" => {}
            id => {
                let values = active.effect().description().parameters.iter().zip(active.values());
                let values: Vec<String> =
                    values.map(|(own, value)| format!("{} {}", own.name, significant(*value))).collect();
                remarks.push(format!("URDF cannot hold {id} ({}).", values.join(", ")));
            }
        }
    }
    let damping = own.answer.repaired.system.nominal().damping();
    let damping = own.repair.damping.map(|_| significant(damping));
    if let Some(armature) =
        own.repair.armature.filter(|found| found.value.abs() > NOTED * own.tracking.inertia)
    {
        remarks.push(format!(
            "URDF cannot hold an armature of {} {turns} (95 % interval {} to {}).",
            significant(armature.value),
            significant(armature.interval_95[0]),
            significant(armature.interval_95[1])
        ));
    }
    if let Some(offset) = own.repair.torque_offset.filter(|own| own.interval_95[0] * own.interval_95[1] > 0.0)
    {
        remarks.push(format!(
            "The torque sensor is off by {} {torque}, or a constant torque of that size acts.",
            significant(offset.value)
        ));
    }
    JointRepair { damping, friction, remarks }
}
