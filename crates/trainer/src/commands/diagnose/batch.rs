//! `trainer diagnose --batch`: diagnosis of every case in a folder.

use super::arguments::DiagnoseArguments;
use super::{kept, labels};
use crate::error::TrainerError;
use crate::outcome::Outcome;
use crate::share::{Launcher, Work, launch, without_launcher};
use crate::terminal::console;
use crate::terminal::interrupt;
use crate::terminal::progress::Progress;
use crate::terminal::table::table;
use estimator::Cancel;
use rayon::prelude::*;
use record::counted;
use results::{BatchResult, CASE_SCHEMA, CaseFile, FailedCase, RESULT_SCHEMA};
use runs::RunFolder;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use workflow::Question;

/// Name of the file with an answer.
pub(crate) const ANSWER: &str = "diagnosis.json";
/// Name of the file that explains why a case has no answer.
pub(crate) const FAILED: &str = "failed.json";

/// Folder with the records of one system.
pub(super) struct Case {
    /// Path of the folder.
    pub(super) folder: PathBuf,
    pub(super) id: String,
    pub(super) records: Vec<PathBuf>,
    pub(super) nominal: PathBuf,
}

impl Case {
    /// Reads the case in a folder, with its records sorted by name. If there is no record, the name of a
    /// first one is listed all the same, so that reading it reports that it is missing.
    pub(super) fn read(path: &Path) -> std::io::Result<Self> {
        let mut records = Vec::new();
        for file in std::fs::read_dir(path)? {
            let file = file?.path();
            let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if name.starts_with("record-") && name.ends_with(".csv") {
                records.push(file);
            }
        }
        records.sort();
        if records.is_empty() {
            records.push(path.join("record-000.csv"));
        }
        let id = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { folder: path.to_owned(), id, records, nominal: path.join("nominal.toml") })
    }
}

/// Outcome of one case.
enum Fate {
    Diagnosed,
    Skipped,
    Failed(FailedCase),
    /// Another process is working on the case.
    Elsewhere,
}

/// Pause between checks of cases that other processes are working on.
const LOOK: Duration = Duration::from_millis(200);

/// Diagnoses the cases in parallel. A case that fails is reported, and the others continue.
pub(super) fn batch(
    arguments: &DiagnoseArguments,
    cases: &Path,
    answers: &Path,
) -> Result<Outcome, TrainerError> {
    let start = Instant::now();
    let cancel = interrupt::watch()?;
    let mut found = list(cases)?;
    if found.is_empty() {
        return Err(TrainerError::NoCases { folder: cases.display().to_string() });
    }
    if let Some(Launcher::Slurm) = arguments.share.launcher {
        return launched(arguments, found.len(), answers);
    }
    found.retain(|case| arguments.share.shard().takes_named(&case.id));
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.map_or(0, usize::from))
        .build()
        .map_err(|error| TrainerError::System { what: "threads", problem: error.to_string() })?;
    let fates = pool.install(|| fates(arguments, &found, answers, cancel));
    let mut result = BatchResult {
        schema: RESULT_SCHEMA.to_owned(),
        task: "diagnose-batch".to_owned(),
        cases: found.len(),
        diagnosed: 0,
        skipped: 0,
        failed: Vec::new(),
        complete: fates.len() == found.len(),
        seconds: start.elapsed().as_secs_f64(),
    };
    for fate in fates.into_values() {
        match fate {
            Fate::Diagnosed => result.diagnosed += 1,
            Fate::Skipped => result.skipped += 1,
            Fate::Failed(case) => result.failed.push(case),
            Fate::Elsewhere => result.complete = false,
        }
    }
    arguments.output.print(&result, || summary(&result, answers))?;
    Ok(match (result.complete, result.failed.is_empty()) {
        (false, _) => Outcome::Interrupted,
        (true, false) => arguments.share.outcome(Outcome::CheckFailed),
        (true, true) => Outcome::Done,
    })
}

/// Diagnoses the cases and returns their outcomes by position; cases not begun before a request to stop are
/// missing. A case that another process is working on is left to that process, and taken over if it ends
/// without an answer.
fn fates(
    arguments: &DiagnoseArguments,
    cases: &[Case],
    answers: &Path,
    cancel: &Cancel,
) -> BTreeMap<usize, Fate> {
    let silent = arguments.output.quiet || arguments.output.json;
    let progress = Progress::over(cases.len() as u64, "cases", silent);
    let mut fates = BTreeMap::new();
    let mut open: Vec<(usize, &Case)> = cases.iter().enumerate().collect();
    for round in 0.. {
        let look = |&(at, case): &(usize, &Case)| {
            if cancel.is_requested() {
                return None;
            }
            let fate = fate(arguments, case, &answers.join(&case.id));
            if let Fate::Failed(failed) = &fate {
                progress.aside(|| console::error(&format!("{}: {}", failed.id, failed.message)));
            }
            if !matches!(fate, Fate::Elsewhere) {
                progress.one_of_many_done();
            }
            Some((at, fate))
        };
        let looked: Vec<_> = open.par_iter().map(look).collect();
        fates.extend(looked.into_iter().flatten());
        open.retain(|(at, _)| matches!(fates.get(at), Some(Fate::Elsewhere)));
        if open.is_empty() || cancel.is_requested() {
            break;
        }
        if round == 0 && !silent {
            progress.aside(|| console::remark("waiting for cases that another process is diagnosing"));
        }
        std::thread::sleep(LOOK);
    }
    progress.finish();
    fates
}

/// Diagnoses a case, unless it already has an answer or another process is working on it.
fn fate(arguments: &DiagnoseArguments, case: &Case, place: &Path) -> Fate {
    let failed = |error: TrainerError| FailedCase { id: case.id.clone(), message: error.to_string() };
    let answer = place.join(ANSWER);
    let check = || {
        let checked = kept::check_answer(arguments, &answer, &case.records, &case.nominal);
        checked.map_or_else(|error| Fate::Failed(failed(error)), |()| Fate::Skipped)
    };
    if answer.exists() {
        return check();
    }
    let folder = match RunFolder::claim(place) {
        Ok(Some(folder)) => folder,
        Ok(None) => return Fate::Elsewhere,
        Err(error) => return Fate::Failed(failed(error.into())),
    };
    if answer.exists() {
        return check();
    }
    match diagnosed(arguments, case, &folder) {
        Ok(()) => Fate::Diagnosed,
        Err(error) => {
            let failed = failed(error);
            // The result of the batch reports the failure as well; failing to write this file is not a
            // failure of its own.
            let _ = folder.write_json(FAILED, &failed);
            Fate::Failed(failed)
        }
    }
}

/// Writes the question and then the answer of a case.
fn diagnosed(arguments: &DiagnoseArguments, case: &Case, folder: &RunFolder) -> Result<(), TrainerError> {
    let question = Question::read(&case.records, &case.nominal, &arguments.reading.plain())?;
    let first = case.records.first().unwrap_or(&case.nominal);
    let labels = labels::read(&case.folder, first)?;
    let answer = question.answer(&arguments.settings(), arguments.seed)?;
    let asked = kept::asked_by_batch(arguments, &question);
    let file = CaseFile { schema: CASE_SCHEMA.to_owned(), asked, labels };
    folder.write_json(kept::CASE_FILE, &file)?;
    folder.write_json(ANSWER, &answer.result)?;
    Ok(folder.remove(FAILED)?)
}

/// Submits the cases to a batch system, with the options of this command line.
fn launched(arguments: &DiagnoseArguments, cases: usize, answers: &Path) -> Result<Outcome, TrainerError> {
    let words: Vec<String> =
        std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let work = Work {
        name: "diagnose",
        folder: &RunFolder::open(answers),
        parts: cases,
        part: "case",
        words: without_launcher(&words),
        threads: arguments.threads.unwrap_or(1),
    };
    launch(&arguments.share, &work, arguments.output)
}

/// Lists the cases sorted by name. A folder without a record is a case too: its failure states what is
/// missing.
fn list(cases: &Path) -> Result<Vec<Case>, TrainerError> {
    let unreadable = |error: std::io::Error| TrainerError::Cases {
        folder: cases.display().to_string(),
        problem: error.to_string(),
    };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(cases).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if !path.is_dir() {
            continue;
        }
        found.push(Case::read(&path).map_err(unreadable)?);
    }
    found.sort_by(|a, b| a.id.cmp(&b.id));
    Ok(found)
}

fn summary(result: &BatchResult, answers: &Path) -> String {
    let row = |name: &str, count: usize| vec![name.to_owned(), count.to_string()];
    let rows = vec![
        row("diagnosed", result.diagnosed),
        row("answered before and left alone", result.skipped),
        row("failed", result.failed.len()),
    ];
    let per_case = result.seconds / result.diagnosed.max(1) as f64;
    format!(
        "{} in {:.1} s, {per_case:.2} s of wall time for each diagnosis{}\n\n{}\n\nanswers: {}/<case>/diagnosis.json",
        counted(result.cases, "case"),
        result.seconds,
        if result.complete { "" } else { ": INTERRUPTED" },
        table(&[], rows),
        answers.display(),
    )
}
