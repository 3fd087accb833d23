//! `trainer diagnose LOG… --nominal ARM.urdf`: a robot of several joints.

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
use ::robot::columns::Stated;
use ::robot::{Model, RobotError};
use rayon::prelude::*;
use results::{FailedCase, JointsResult};
use runs::{RunFolder, default_root};
use serde_json::{Value, json};
use std::path::Path;
use std::time::Instant;
use workflow::WorkflowError;
use workflow::robot::{JointAnswer, JointQuestion, RobotOptions, RobotQuestion};

/// Returns `true` if a nominal simulator is the model of a robot.
pub(super) fn is_robot(nominal: &Path) -> bool {
    nominal.extension().is_some_and(|own| own.eq_ignore_ascii_case("urdf") || own.eq_ignore_ascii_case("xml"))
}

/// Outcome of one joint.
type Fate = Result<(JointQuestion, Value, JointAnswer), FailedCase>;

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

/// Diagnoses every joint and checks the whole model. A joint that fails is reported, and the others continue.
pub(super) fn robot(arguments: &DiagnoseArguments, model: &Path) -> Result<Outcome, TrainerError> {
    let start = Instant::now();
    if let Some(path) = &arguments.out {
        RunFolder::check_free(path)?;
    }
    let question =
        RobotQuestion::read(&arguments.records, model, &options(arguments)?, &arguments.reading.plain())?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.map_or(0, usize::from))
        .build()
        .map_err(|error| TrainerError::System { what: "threads", problem: error.to_string() })?;
    interrupt::watch_impatiently()?;
    let quiet = arguments.output.quiet || arguments.output.json;
    let progress = Progress::over(question.asked.len() as u64, "joints", quiet);
    let fates: Vec<Fate> = pool.install(|| {
        let diagnosed = |joint: &usize| {
            let fate = diagnosed(arguments, &question, *joint, &progress);
            progress.one_of_many_done();
            fate
        };
        question.asked.par_iter().map(diagnosed).collect()
    });
    progress.finish();
    let (mut parts, mut answers, mut failed) = (Vec::new(), Vec::new(), Vec::new());
    for fate in fates {
        match fate {
            Ok((question, asked, answer)) => {
                parts.push((question, asked));
                answers.push(answer);
            }
            Err(case) => failed.push(case),
        }
    }
    let mut notes = Vec::new();
    let checked = pool.install(|| question.closed_loop(&answers, &arguments.settings(), arguments.seed));
    let closed_loop =
        checked.map_err(|error| notes.push(format!("The whole model was not run: {error}."))).ok();
    let result = question.result(&answers, failed, closed_loop, (notes, start.elapsed().as_secs_f64()));
    let _saving = Saving::begin();
    let folder = match &arguments.out {
        Some(path) => RunFolder::create_at(path)?,
        None => RunFolder::create(&default_root(), "robot")?,
    };
    keep(&folder, &question, (&parts, &answers), &result, pool.current_num_threads())?;
    arguments.output.print(&result, || summary::summary(&result, folder.path()))?;
    Ok(Outcome::of(false, result.failed.is_empty()))
}

fn diagnosed(
    arguments: &DiagnoseArguments,
    question: &RobotQuestion,
    joint: usize,
    progress: &Progress,
) -> Fate {
    let fitted: Vec<usize> = (0..question.recordings.len())
        .filter(|index| question.recordings.get(*index).is_some_and(|own| own.fitted))
        .collect();
    let answer = || -> Result<_, WorkflowError> {
        let own = question.joint(joint, &fitted, 1.0)?;
        let asked = kept::asked(arguments, &own.question);
        let answer = own.answer(&arguments.settings(), arguments.seed, &|_| true)?;
        Ok((own, asked, answer))
    };
    answer().map_err(|error| {
        // The index is that of a joint of the model.
        let id = question.model.joints().get(joint).map(|own| own.name.clone()).unwrap_or_default();
        let message = error.to_string();
        progress.aside(|| console::error(&format!("{id}: {message}")));
        FailedCase { id, message }
    })
}

/// Writes the folder of a robot, with a folder for each joint, and the report last.
fn keep(
    folder: &RunFolder,
    question: &RobotQuestion,
    (parts, answers): (&[(JointQuestion, Value)], &[JointAnswer]),
    result: &JointsResult,
    threads: usize,
) -> Result<(), TrainerError> {
    for ((own, asked), answer) in parts.iter().zip(answers) {
        let name: String = own
            .joint
            .name
            .chars()
            .map(|sign| if sign.is_alphanumeric() || "-_.".contains(sign) { sign } else { '_' })
            .collect();
        let joint = RunFolder::create_at(&folder.path().join(name.trim_start_matches('.')))?;
        kept::keep(&joint, &own.question, asked, &answer.answer, threads)?;
    }
    let digests: Vec<&str> = result.recordings.iter().map(|own| own.digest.as_str()).collect();
    folder.write_json("environment.json", &Environment::new(threads, &digests.join(" ")))?;
    folder.write("repaired.urdf", question.repaired_urdf(answers).as_bytes())?;
    folder.write_json("joints.json", result)?;
    folder.record_event("end", &json!({ "joints": result.joints.len() }))?;
    write_report(folder)?;
    Ok(())
}
