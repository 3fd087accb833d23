//! `trainer diagnose`: location of the gap between a nominal simulator and records, and its repair.

pub(crate) mod arguments;
pub(crate) mod batch;
mod kept;
mod labels;
mod rigs;
mod robot;
mod summary;

use crate::error::{LaunchError, TrainerError};
use crate::outcome::Outcome;
use crate::terminal::interrupt::{self, Saving};
use crate::terminal::progress::Progress;
use arguments::DiagnoseArguments;
use diagnosis::{Observations, Stage};
use dynamics::Nominal;
use record::Quantity;
use runs::{Disk, RunFolder, default_root};
use std::path::{Path, PathBuf};
use trials::BaselineRecord;
use workflow::{Question, Reading, after};

/// Diagnoses the given records, or every case of a batch.
pub(crate) fn command(arguments: &DiagnoseArguments) -> Result<Outcome, TrainerError> {
    let shared =
        [("--shard", arguments.share.shard.is_some()), ("--launcher", arguments.share.launcher.is_some())];
    if let (None, Some((option, _))) = (&arguments.batch, shared.into_iter().find(|(_, given)| *given)) {
        return Err(LaunchError::NoBatch { option }.into());
    }
    // A folder of records may hold the nominal simulator with which they are compared.
    let beside =
        arguments.records.first().map(|first| first.join("nominal.toml")).filter(|file| file.is_file());
    match (&arguments.batch, &arguments.out, arguments.nominal.as_ref().or(beside.as_ref())) {
        (Some(cases), Some(answers), _) => batch::batch(arguments, cases, answers),
        _ if !arguments.rigs.is_empty() => rigs::rigs(arguments),
        (_, _, Some(model)) if robot::is_robot(model) => robot::robot(arguments, model),
        (_, _, Some(nominal)) => single(arguments, nominal),
        _ => Err(TrainerError::NoNominal {
            record: arguments.records.first().map(|path| path.display().to_string()).unwrap_or_default(),
        }),
    }
}

/// Input of a case's diagnosis, for simpler diagnosers.
pub(crate) struct GivenCase {
    pub(crate) nominal: Nominal,
    /// Observations that a diagnosis gets.
    pub(crate) observations: Vec<Observations>,
    /// Records of positions only; empty if the sensor observes something else.
    pub(crate) records: Vec<BaselineRecord>,
}

/// Reads records and their nominal simulator with the default options of a batch.
pub(crate) fn given(records: &[PathBuf], nominal: &Path) -> Result<GivenCase, TrainerError> {
    let question = Question::read(records, nominal, &Reading::default())?;
    let positions = question.given.iter().filter(|given| given.quantity == Quantity::Position);
    let records = positions.map(|given| BaselineRecord {
        times_s: given.observations.times_s().to_vec(),
        values: given.observations.values().to_vec(),
        input: given.observations.input().map(<[f64]>::to_vec),
    });
    let records = records.collect();
    let nominal = question.stated.nominal;
    let observations = question.given.into_iter().map(|given| given.observations).collect();
    Ok(GivenCase { nominal, observations, records })
}

fn single(arguments: &DiagnoseArguments, nominal: &Path) -> Result<Outcome, TrainerError> {
    // Checked before the work starts rather than after it. A new folder is created only once there is an
    // answer.
    let begun = match &arguments.out {
        Some(path) if arguments.resume && path.exists() => {
            Some(RunFolder::resume_on(&Disk::default(), path)?)
        }
        Some(path) => {
            RunFolder::check_free(path)?;
            None
        }
        None => None,
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.map_or(0, usize::from))
        .build()
        .map_err(|error| TrainerError::System { what: "threads", problem: error.to_string() })?;
    interrupt::watch_impatiently()?;
    let question = Question::read(&arguments.records, nominal, &arguments.reading.plain())?;
    let asked = kept::asked(arguments, &question);
    if let Some(folder) = &begun
        && let Some(result) = kept::finished(folder, &asked)?
    {
        arguments.output.print(&result, || {
            let shown = folder.path().display();
            format!(
                "{}\n\n{shown}: this diagnosis is finished; nothing was changed",
                summary::summary(&result, folder.path())
            )
        })?;
        return Ok(Outcome::Done);
    }
    let progress = Progress::over_stages(after(None), arguments.output.quiet || arguments.output.json);
    let goes_on = |done: Stage| {
        progress.stage(after(Some(done)));
        true
    };
    let answer = pool.install(|| question.answer_watched(&arguments.settings(), arguments.seed, &goes_on));
    progress.finish();
    let answer = answer?;
    let _saving = Saving::begin();
    let folder = match (begun, &arguments.out) {
        (Some(folder), _) => folder,
        (None, Some(path)) => RunFolder::create_at(path)?,
        (None, None) => RunFolder::create(&default_root(), "diagnosis")?,
    };
    kept::keep(&folder, &question, &asked, &answer, pool.current_num_threads())?;
    arguments.output.print(&answer.result, || summary::summary(&answer.result, folder.path()))?;
    Ok(Outcome::Done)
}
