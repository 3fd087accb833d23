//! One joint of a robot as a question of one oscillator, and its answer as that of the joint.

use super::read::{LoadedRecording, RobotQuestion};
use crate::error::WorkflowError;
use crate::question::{Answer, Question};
use crate::read::Given;
use diagnosis::{DiagnosisError, Settings, Stage};
use dynamics::tree::Acting;
use dynamics::{
    Active, Coefficients, Coordinate, DynamicsError, Hold, KnownEffect, Nominal, NominalSimulator, REGISTRY,
    System,
};
use experiment::StatedNominal;
use export::{equation_latex, equation_text};
use record::{Fault, Quantity, Record};
use results::{CalibratedRow, Calibration, Equation, JointRepairRow, TrackingRow, WithInterval};
use robot::{Along, Gain, JointInfo, Projected, RobotError, Scale, Tracking, project};
use std::f64::consts::TAU;

/// Effects that are no candidates for a joint, beside those of a drive, which would change the whole computed one, of which the
/// measured torque is only a part: they would change the spring and damper that hold its simulator, or bend the sensor's
/// readings, from which the drive is computed too. A constant torque is part of the calibration. Any line of the drive's
/// noise, which is red, would pass for a forcing or a second body. The weight of links depends on all joints and is the
/// model's; along one joint's angle, with a spring, it would only imitate a spring that hardens.
const NOT_OF_A_JOINT: [&str; 12] = [
    "backlash",
    "stiffness_drift",
    "damping_drift",
    "sensor_lag",
    "sensor_nonlinearity",
    "sensor_drift",
    "sensor_saturation",
    "clock_drift",
    "constant_torque",
    "periodic_forcing",
    "flexible_coupling",
    "gravity",
];

/// Effect that stands for the offset of a torque sensor.
const OFFSET: &str = "constant_torque";

/// One joint along the measured motion.
pub struct JointQuestion {
    /// Joint as the model describes it.
    pub joint: JointInfo,
    /// Spring and damper that hold its simulator to the measured motion.
    pub tracking: Tracking,
    /// Behavior of the drive's torque between samples.
    pub hold: Hold,
    /// Size of the motion.
    pub scale: Scale,
    /// Mean of the constant torques that were taken out of the drive, in N m or N.
    pub offset: f64,
    /// Gain of the torque sensor; `None` if it is not told from 1.
    pub gain: Option<Gain>,
    /// Question of the joint as an oscillator.
    pub question: Question,
}

/// Answer for one joint.
pub struct JointAnswer {
    /// Joint as the model describes it.
    pub joint: JointInfo,
    /// Answer, with the coefficients of the joint itself.
    pub answer: Answer,
    /// Spring and damper that held its simulator to the measured motion.
    pub tracking: TrackingRow,
    /// Coefficients beside those of the effects.
    pub repair: JointRepairRow,
    /// Behavior of the drive's torque between samples.
    pub hold: Hold,
    /// Size of the motion.
    pub scale: Scale,
    /// Torques in the joint beside its drive: as given, recalibrated, and repaired.
    pub acting: [Acting; 3],
}

impl RobotQuestion {
    /// Builds the question of one joint from recordings by index, or from a part of each, by the share of its
    /// samples from the beginning.
    ///
    /// # Errors
    /// [`WorkflowError`].
    pub fn joint(
        &self,
        joint: usize,
        recordings: &[usize],
        share: f64,
    ) -> Result<JointQuestion, WorkflowError> {
        let used: Vec<&LoadedRecording> =
            recordings.iter().filter_map(|index| self.recordings.get(*index)).collect();
        let along: Vec<&Along> = used.iter().map(|own| &own.along).collect();
        let projected = project(self.model.joints(), &along, joint, share)?;
        let info = self.model.joints().get(joint).cloned().ok_or_else(|| RobotError::Model {
            quantity: "joint",
            problem: format!("it has no joint {joint}"),
        })?;
        let stated = stated(&info, &projected.tracking, &self.name)?;
        let mut given = Vec::new();
        for (own, part) in used.iter().zip(&projected.parts) {
            given.push(of_part(own, &projected, part, &stated)?);
        }
        let question = Question::new(given, stated, self.name.clone())?;
        let count = projected.parts.len().max(1) as f64;
        let offset = projected.parts.iter().map(|part| part.offset).sum::<f64>() / count;
        let Projected { tracking, hold, scale, gain, .. } = projected;
        Ok(JointQuestion { joint: info, tracking, hold, scale, offset, gain, question })
    }
}

/// Returns the nominal simulator of a joint, held to the measured motion.
fn stated(joint: &JointInfo, tracking: &Tracking, file: &str) -> Result<StatedNominal, WorkflowError> {
    let refused = |error: DynamicsError| WorkflowError::Nominal {
        file: file.to_owned(),
        problem: format!("joint `{}`: {error}", joint.name),
    };
    let coordinate = if joint.slides { Coordinate::Displacement } else { Coordinate::Angle };
    let nominal = Nominal::from_coefficients(Coefficients {
        inertia: tracking.inertia,
        damping: tracking.damping + joint.damping,
        stiffness: tracking.stiffness,
        rest_angle: 0.0,
        input_gain: 1.0,
    })
    .map_err(refused)?
    .with_coordinate(coordinate);
    // Springs of a joint are relaxed at its zero, wherever a torque beside them holds it.
    let offset = Active::named(OFFSET, &[("torque", 0.0)]).map_err(refused)?;
    let mut effects = vec![KnownEffect { active: offset, recalibrate: true }];
    if joint.friction > 0.0 {
        let active = Active::named("coulomb_friction", &[("torque", joint.friction)]).map_err(refused)?;
        effects.push(KnownEffect { active, recalibrate: true });
    }
    let simulator = NominalSimulator::new(nominal, effects).map_err(refused)?;
    Ok(StatedNominal { nominal, simulator, driven: true, actuator: None })
}

/// Returns the samples of one joint in a recording with its drive as input.
fn of_part(
    own: &LoadedRecording,
    projected: &Projected,
    part: &robot::Part,
    stated: &StatedNominal,
) -> Result<Given, WorkflowError> {
    let name = &own.along.recording().name;
    let short = || RobotError::Short { log: name.clone(), seconds: 0.0 };
    let loaded = own.joints.get(projected.joint).ok_or_else(short)?;
    let range = part.from..part.from + part.drive.len();
    let cut = |values: &[f64]| values.get(range.clone()).map(<[f64]>::to_vec).ok_or_else(short);
    let (stamps, values) = (cut(loaded.record.stamps_s())?, cut(loaded.record.values())?);
    let record =
        Record::new(stamps, values, Some(part.drive.clone()), Quantity::Position, loaded.record.unit());
    let fault = |fault: Fault| WorkflowError::Record(fault.in_file(name));
    let mut record = record.map_err(fault)?;
    if let Some(rows) = loaded.record.rows() {
        record = record.with_rows(rows.get(range.clone()).map(<[usize]>::to_vec).ok_or_else(short)?);
    }
    let mut loaded = crate::read::Loaded { record, ..loaded.clone() };
    // Angles of several turns were checked when the recording was read.
    loaded.source.reading.value.unit = None;
    let mut given = loaded.given(stated)?;
    given.observations = given.observations.with_drive_noise(projected.drive_noise);
    Ok(given)
}

impl JointQuestion {
    /// Computes the diagnosis of the joint.
    ///
    /// # Errors
    /// As [`Question::answer`].
    pub fn answer(
        &self,
        settings: &Settings,
        seed: u64,
        goes_on: &(dyn Fn(Stage) -> bool + Sync),
    ) -> Result<JointAnswer, WorkflowError> {
        let mut settings = settings.clone();
        let of_a_drive =
            REGISTRY.iter().filter(|effect| effect.description().driven_only).map(|own| own.id());
        settings.without.extend(NOT_OF_A_JOINT.into_iter().chain(of_a_drive).map(str::to_owned));
        // The drive was computed for this behavior; that of the torque is in it.
        settings.hold = Some(Hold::Linear);
        let mut answer = self.question.answer_watched(&settings, seed, goes_on)?;
        for finding in &mut answer.result.measuring_chain.findings {
            if finding.text.starts_with("for the model, the input") {
                finding.text = format!("for the model, the torque {}", self.hold.in_words());
            }
        }
        let Tracking { inertia, damping, stiffness } = self.tracking;
        let calibration = answer.result.calibration.clone();
        let with_sensor = |mut own: JointRepairRow| {
            own.torque_offset = own.torque_offset.map(|found| less(found, -self.offset));
            own.torque_gain = self.gain.map(|gain| WithInterval::normal(gain.value, gain.std_error));
            own
        };
        let repair = with_sensor(beyond(&calibration, &self.tracking, |row| row.repaired));
        let recalibrated = with_sensor(beyond(&calibration, &self.tracking, |row| row.recalibrated));
        let acting = [
            Acting {
                damping: self.joint.damping,
                effects: beside_offset(&self.known()),
                ..Acting::default()
            },
            acting(&self.joint, &recalibrated, &self.recalibrated(&answer)),
            acting(&self.joint, &repair, &answer.found.repaired.effects),
        ];
        free(&mut answer, &self.tracking, &repair)?;
        Ok(JointAnswer {
            joint: self.joint.clone(),
            tracking: TrackingRow {
                inertia,
                stiffness,
                damping,
                frequency_hz: (stiffness / inertia).sqrt() / TAU,
            },
            answer,
            repair,
            hold: self.hold,
            scale: self.scale,
            acting,
        })
    }

    /// Returns the effects that the model has.
    fn known(&self) -> Vec<Active> {
        self.question.stated.simulator.effects().iter().map(|known| known.active).collect()
    }

    /// Returns the effects that the model has, with their recalibrated numbers.
    fn recalibrated(&self, answer: &Answer) -> Vec<Active> {
        let rows = &answer.result.calibration.effects;
        let of = |active: &Active| {
            let row = rows.iter().find(|row| row.id == active.id());
            let numbers = row.map(|row| {
                let value = |own: &CalibratedRow| own.recalibrated.map_or(own.nominal, |own| own.value);
                row.parameters.iter().map(move |(name, own)| (name.as_str(), value(own)))
            });
            let numbers: Vec<(&str, f64)> = numbers.into_iter().flatten().collect();
            Active::named(active.id(), &numbers).unwrap_or(*active)
        };
        self.known().iter().map(of).collect()
    }
}

/// Returns an estimate less a constant.
fn less(own: WithInterval, by: f64) -> WithInterval {
    WithInterval { value: own.value - by, interval_95: own.interval_95.map(|end| end - by) }
}

/// Returns the coefficients of a joint from those of its oscillator.
fn beyond(
    calibration: &Calibration,
    tracking: &Tracking,
    of: impl Fn(&CalibratedRow) -> Option<WithInterval>,
) -> JointRepairRow {
    let offset = calibration.effects.iter().find(|row| row.id == OFFSET);
    JointRepairRow {
        armature: of(&calibration.inertia).map(|own| less(own, tracking.inertia)),
        damping: of(&calibration.damping).map(|own| less(own, tracking.damping)),
        stiffness: of(&calibration.stiffness).map(|own| less(own, tracking.stiffness)),
        torque_offset: offset.and_then(|row| row.parameters.values().find_map(&of)),
        torque_gain: None,
    }
}

/// Returns what acts in a joint by its fitted coefficients; one that is not determined is 0.
fn acting(joint: &JointInfo, repair: &JointRepairRow, effects: &[Active]) -> Acting {
    let value = |own: Option<WithInterval>| own.map_or(0.0, |own| own.value);
    Acting {
        // A file that holds an armature holds none below 0.
        inertia: value(repair.armature).max(joint.armature.map_or(f64::NEG_INFINITY, |own| -own)),
        // A damper gives no energy: a value below 0 is an error of the fit, as in the repaired model.
        damping: value(repair.damping).max(0.0),
        stiffness: value(repair.stiffness),
        torque: value(repair.torque_offset),
        effects: beside_offset(effects),
    }
}

/// Returns the effects but for the offset, which a joint has as a number of its own.
fn beside_offset(effects: &[Active]) -> Vec<Active> {
    effects.iter().filter(|active| active.id() != OFFSET).copied().collect()
}

/// Takes spring and damper out of an answer: the joint alone remains.
fn free(answer: &mut Answer, tracking: &Tracking, repair: &JointRepairRow) -> Result<(), WorkflowError> {
    let shift = |row: &mut CalibratedRow, by: f64| {
        row.nominal -= by;
        row.recalibrated = row.recalibrated.map(|own| less(own, by));
        row.repaired = row.repaired.map(|own| less(own, by));
    };
    let calibration = &mut answer.result.calibration;
    shift(&mut calibration.damping, tracking.damping);
    shift(&mut calibration.stiffness, tracking.stiffness);
    // The offset stands with the joint.
    calibration.effects.retain(|row| row.id != OFFSET);
    let refused = |error: DynamicsError| WorkflowError::Diagnosis {
        file: answer.result.nominal.clone(),
        source: DiagnosisError::Dynamics(error),
    };
    let own = *answer.repaired.system.nominal();
    let mut effects = beside_offset(answer.repaired.system.effects());
    if let Some(offset) = repair.torque_offset.filter(|own| own.value != 0.0) {
        effects.push(Active::named(OFFSET, &[("torque", offset.value)]).map_err(refused)?);
    }
    // Neither a damper nor a spring of a joint gives energy: a value below 0 is an error of the fit.
    let nominal = own
        .with_coefficients(Coefficients {
            damping: (own.damping() - tracking.damping).max(0.0),
            stiffness: (own.stiffness() - tracking.stiffness).max(0.0),
            ..own.coefficients()
        })
        .map_err(refused)?;
    answer.repaired.system = System::new(nominal, effects).map_err(refused)?;
    answer.result.equation =
        Equation { text: equation_text(&answer.repaired), latex: equation_latex(&answer.repaired) };
    Ok(())
}
