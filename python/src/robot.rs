//! Robots of several joints.

use crate::diagnosis::options_of;
use crate::error::{ConfigError, raised};
use crate::record::reading_of;
use crate::work::{beside, on_threads};
use pyo3::prelude::*;
use ringdown_lab::{Joints, JointsOptions, Robot, Simulator, diagnose_robot};
use std::path::PathBuf;

/// The model of a robot.
#[pyclass(frozen, module = "ringdown_lab._native", name = "NativeRobot")]
pub(crate) struct NativeRobot {
    robot: Robot,
}

/// What answers a question in JSON: a Python callable.
struct Callable(Py<PyAny>);

impl Simulator for Callable {
    fn ask(&self, question: &str) -> Result<String, String> {
        Python::attach(|py| self.0.call1(py, (question,))?.extract(py))
            .map_err(|error: PyErr| error.to_string())
    }
}

#[pymethods]
impl NativeRobot {
    /// A URDF.
    #[staticmethod]
    fn from_urdf(path: PathBuf) -> PyResult<Self> {
        Ok(Self { robot: Robot::from_urdf(path).map_err(raised)? })
    }

    /// A simulator that answers questions in JSON; `text` is its file, if that is MJCF.
    #[staticmethod]
    fn of(py: Python<'_>, name: String, answer: Py<PyAny>, text: Option<String>) -> PyResult<Self> {
        let made = beside(py, None, move |_| Robot::from_simulator(&name, Box::new(Callable(answer)), text))?;
        Ok(Self { robot: made.map_err(raised)? })
    }

    /// Names of the joints.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.robot.joints().into_iter().map(str::to_owned).collect()
    }
}

/// The diagnosis of a robot.
#[pyclass(frozen, module = "ringdown_lab._native", name = "NativeJoints")]
pub(crate) struct NativeJoints {
    joints: Joints,
}

#[pymethods]
impl NativeJoints {
    /// The content of `joints.json`.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string_pretty(self.joints.result())
            .map_err(|error| ConfigError::new_err(error.to_string()))
    }

    /// The text of the repaired model.
    #[getter]
    fn repaired(&self) -> Option<&str> {
        self.joints.repaired()
    }
}

/// Diagnoses a robot from logs.
#[pyfunction]
#[pyo3(signature = (logs, robot, *, joints, columns, check, reading, false_alarm, most_effects, without, seed, threads, progress))]
#[expect(clippy::too_many_arguments, reason = "named arguments of a Python function")]
pub(crate) fn diagnose_joints(
    py: Python<'_>,
    logs: Vec<PathBuf>,
    robot: &Bound<'_, NativeRobot>,
    joints: Vec<String>,
    columns: Vec<String>,
    check: Vec<PathBuf>,
    reading: &str,
    false_alarm: Option<f64>,
    most_effects: Option<usize>,
    without: Vec<String>,
    seed: u64,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<NativeJoints> {
    let robot = robot.get().robot.clone();
    let diagnosis = options_of(false_alarm, most_effects, without, seed);
    let options = JointsOptions { joints, columns, check, reading: reading_of(reading)?, diagnosis };
    let joints = beside(py, progress, move |watch| {
        let goes_on = |stage: &'static str| watch.tell(stage);
        on_threads(threads, || diagnose_robot(&logs, &robot, &options, &goes_on))
    })??;
    Ok(NativeJoints { joints: joints.map_err(raised)? })
}
