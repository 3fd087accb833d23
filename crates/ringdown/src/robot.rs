//! Robots of several joints.

use crate::Reading;
use crate::diagnose::DiagnosisOptions;
use crate::error::Error;
use crate::nominal::config;
use ::robot::columns::Stated;
use ::robot::{Foreign, Model, RobotError, Simulator, Urdf};
use results::JointsResult;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use workflow::WorkflowError;
use workflow::robot::{RobotAnswer, RobotOptions, RobotQuestion};

/// Model of a robot: a URDF, or another simulator.
#[derive(Clone)]
pub struct Robot {
    model: Arc<dyn Model>,
    name: String,
}

/// Options of a robot's diagnosis, with the defaults of the command line.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointsOptions {
    /// Names of the joints to diagnose; all if empty.
    pub joints: Vec<String>,
    /// Columns where the header does not tell: `JOINT=POSITION,TORQUE`.
    pub columns: Vec<String>,
    /// Recordings that are not fitted, with which the whole model is checked.
    pub check: Vec<PathBuf>,
    /// Options of reading.
    pub reading: Reading,
    /// Options of each joint's diagnosis.
    pub diagnosis: DiagnosisOptions,
}

/// Diagnosis of a robot, joint by joint.
pub struct Joints {
    answer: RobotAnswer,
}

fn refused(error: RobotError) -> Error {
    WorkflowError::Robot(error).into()
}

impl Robot {
    /// Reads a URDF.
    ///
    /// # Errors
    /// [`Error::Config`] with line and column.
    pub fn from_urdf(path: impl AsRef<Path>) -> Result<Self, Error> {
        let name = path.as_ref().display().to_string();
        let text = std::fs::read_to_string(path.as_ref())
            .map_err(|error| config(format!("{name}: cannot be read: {error}")))?;
        let model = Urdf::parse(&name, &text).map_err(refused)?;
        Ok(Self { model: Arc::new(model), name })
    }

    /// Uses another simulator, which answers questions in text. `text` is its file if that is MJCF.
    ///
    /// # Errors
    /// [`Error::Config`] if it does not describe itself.
    pub fn from_simulator(
        name: &str,
        simulator: Box<dyn Simulator>,
        text: Option<String>,
    ) -> Result<Self, Error> {
        let model = Foreign::new(simulator).map_err(refused)?;
        let model = match text {
            Some(text) => model.with_text(text),
            None => model,
        };
        Ok(Self { model: Arc::new(model), name: name.to_owned() })
    }

    /// Returns the names of the joints, in the order of all vectors.
    #[must_use]
    pub fn joints(&self) -> Vec<&str> {
        self.model.joints().iter().map(|own| own.name.as_str()).collect()
    }
}

/// Diagnoses a robot from logs of all its joints: a folder stands for the logs in it. `goes_on` is asked after each stage of
/// a joint.
///
/// # Errors
/// [`Error::Record`] for logs that cannot be used, [`Error::Config`] for options and models.
pub fn diagnose_robot(
    logs: &[PathBuf],
    robot: &Robot,
    options: &JointsOptions,
    goes_on: &(dyn Fn(&'static str) -> bool + Sync),
) -> Result<Joints, Error> {
    let columns = options.columns.iter().map(|text| Stated::parse(text));
    let asked = RobotOptions {
        joints: options.joints.clone(),
        columns: columns.collect::<Result<_, _>>().map_err(refused)?,
        armatures: Vec::new(),
        check: options.check.clone(),
    };
    let question =
        RobotQuestion::of(Arc::clone(&robot.model), robot.name.clone(), logs, &asked, &options.reading)?;
    let answer = question.answer(
        &options.diagnosis.settings()?,
        options.diagnosis.seed,
        &|stage| goes_on(stage.name()),
        &|_| {},
    );
    Ok(Joints { answer })
}

impl Joints {
    /// Returns the content of `joints.json`.
    #[must_use]
    pub fn result(&self) -> &JointsResult {
        &self.answer.result
    }

    /// Returns the text of the repaired model; `None` for a model that is no file.
    #[must_use]
    pub fn repaired(&self) -> Option<&str> {
        self.answer.repaired.as_ref().map(|own| own.text.as_str())
    }
}
