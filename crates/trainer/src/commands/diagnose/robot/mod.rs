//! `trainer diagnose LOG… --nominal ARM.urdf` or `ARM.xml`: a robot of several joints.

mod interpreter;
mod summary;

use super::arguments::DiagnoseArguments;
use super::kept;
use crate::error::TrainerError;
use crate::folders::environment::Environment;
use crate::folders::page::write_report;
use crate::outcome::Outcome;
use crate::terminal::console;
use crate::terminal::interrupt::{self, Saving};
use crate::terminal::progress::Progress;
use ::robot::RobotError;
use ::robot::columns::Stated;
use results::FailedCase;
use runs::{RunFolder, default_root};
use serde_json::json;
use std::path::Path;
use std::sync::Arc;
use workflow::WorkflowError;
use workflow::robot::{JointFate, RobotAnswer, RobotOptions, RobotQuestion};

/// Returns `true` if a nominal simulator is the model of a robot.
pub(super) fn is_robot(nominal: &Path) -> bool {
    nominal.extension().is_some_and(|own| own.eq_ignore_ascii_case("urdf") || own.eq_ignore_ascii_case("xml"))
}

/// Reads the options of a robot.
fn options(arguments: &DiagnoseArguments) -> Result<RobotOptions, TrainerError> {
    let refused = |error: RobotError| TrainerError::Workflow(WorkflowError::Robot(error));
    let columns = arguments.robot.columns.iter().map(|text| Stated::parse(text));
    let armature = |text: &String| {
        let form = || RobotError::Form {
            text: text.clone(),
            expected: "JOINT=INERTIA with a number of kg m^2 (kg for a prismatic joint), such as elbow=0.0028",
        };
        let (joint, value) = text.split_once('=').ok_or_else(form)?;
        Ok((joint.trim().to_owned(), value.trim().parse().map_err(|_| form())?))
    };
    Ok(RobotOptions {
        joints: arguments.robot.joints.clone(),
        columns: columns.collect::<Result<_, _>>().map_err(refused)?,
        armatures: arguments
            .robot
            .armatures
            .iter()
            .map(armature)
            .collect::<Result<_, _>>()
            .map_err(refused)?,
        check: arguments.robot.check.clone(),
    })
}

/// Returns `true` for the text of an MJCF model, which an `.xml` holds as well as a URDF.
fn is_mjcf(model: &Path) -> bool {
    let text = std::fs::read_to_string(model);
    model.extension().is_some_and(|own| own.eq_ignore_ascii_case("xml"))
        && text.is_ok_and(|own| !own.contains("<robot"))
}

/// Reads the recordings and the model: an MJCF model through Python.
fn question(arguments: &DiagnoseArguments, model: &Path) -> Result<RobotQuestion, TrainerError> {
    let (options, reading) = (options(arguments)?, arguments.reading.plain());
    if !is_mjcf(model) {
        return Ok(RobotQuestion::read(&arguments.records, model, &options, &reading)?);
    }
    let mjcf = interpreter::mjcf(model).and_then(|own| own.with_armatures(&options.armatures));
    let mjcf = Arc::new(mjcf.map_err(WorkflowError::Robot)?);
    Ok(RobotQuestion::of(mjcf, model.display().to_string(), &arguments.records, &options, &reading)?)
}

/// Diagnoses every joint and checks the whole model. A joint that fails is reported, and the others continue.
pub(super) fn robot(arguments: &DiagnoseArguments, model: &Path) -> Result<Outcome, TrainerError> {
    if let Some(path) = &arguments.out {
        RunFolder::check_free(path)?;
    }
    let question = question(arguments, model)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.map_or(0, usize::from))
        .build()
        .map_err(|error| TrainerError::System { what: "threads", problem: error.to_string() })?;
    interrupt::watch_impatiently()?;
    let quiet = arguments.output.quiet || arguments.output.json;
    let progress = Progress::over(question.asked.len() as u64, "joints", quiet);
    let done = |fate: &JointFate| {
        if let Err(FailedCase { id, message }) = fate {
            progress.aside(|| console::error(&format!("{id}: {message}")));
        }
        progress.one_of_many_done();
    };
    let answer = pool.install(|| question.answer(&arguments.settings(), arguments.seed, &|_| true, &done));
    progress.finish();
    let _saving = Saving::begin();
    let folder = match &arguments.out {
        Some(path) => RunFolder::create_at(path)?,
        None => RunFolder::create(&default_root(), "robot")?,
    };
    keep(&folder, arguments, &answer, pool.current_num_threads())?;
    arguments.output.print(&answer.result, || summary::summary(&answer, folder.path()))?;
    Ok(Outcome::of(false, answer.result.failed.is_empty()))
}

/// Writes the folder of a robot, with a folder for each joint, and the report last.
fn keep(
    folder: &RunFolder,
    arguments: &DiagnoseArguments,
    RobotAnswer { joints, result, repaired }: &RobotAnswer,
    threads: usize,
) -> Result<(), TrainerError> {
    for (own, answer) in joints {
        let name: String = own
            .joint
            .name
            .chars()
            .map(|sign| if sign.is_alphanumeric() || "-_.".contains(sign) { sign } else { '_' })
            .collect();
        let joint = RunFolder::create_at(&folder.path().join(name.trim_start_matches('.')))?;
        let asked = kept::asked(arguments, &own.question);
        kept::keep(&joint, &own.question, &asked, &answer.answer, threads)?;
    }
    let digests: Vec<&str> = result.recordings.iter().map(|own| own.digest.as_str()).collect();
    folder.write_json("environment.json", &Environment::new(threads, &digests.join(" ")))?;
    if let Some(model) = repaired {
        folder.write(&format!("repaired.{}", model.extension), model.text.as_bytes())?;
    }
    folder.write_json("joints.json", result)?;
    folder.record_event("end", &json!({ "joints": result.joints.len() }))?;
    write_report(folder)?;
    Ok(())
}
