//! `trainer diagnose --batch`: every case of a folder.

use super::arguments::DiagnoseArguments;
use super::{kept, settings};
use crate::error::TrainerError;
use crate::outcome::Outcome;
use crate::terminal::console;
use crate::terminal::interrupt;
use crate::terminal::progress::Progress;
use crate::terminal::table::table;
use rayon::prelude::*;
use record::counted;
use results::{BatchResult, FailedCase, RESULT_SCHEMA};
use runs::RunFolder;
use std::path::{Path, PathBuf};
use std::time::Instant;
use workflow::Question;

/// A folder with records of one system.
pub(super) struct Case {
    pub(super) id: String,
    pub(super) records: Vec<PathBuf>,
    pub(super) nominal: PathBuf,
}

impl Case {
    /// The case in a folder: its records by their names. Without one, the first is named all the same, so that reading it
    /// says that it is not there.
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
        Ok(Self { id, records, nominal: path.join("nominal.toml") })
    }
}

/// What became of a case.
enum Fate {
    Diagnosed,
    Skipped,
    Failed(FailedCase),
}

/// Diagnoses the cases in parallel. A bad case is reported and the others go on.
pub(super) fn batch(
    arguments: &DiagnoseArguments,
    cases: &Path,
    answers: &Path,
) -> Result<Outcome, TrainerError> {
    let start = Instant::now();
    let cancel = interrupt::watch()?;
    let found = list(cases)?;
    if found.is_empty() {
        return Err(TrainerError::NoCases { folder: cases.display().to_string() });
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.map_or(0, usize::from))
        .build()
        .map_err(|error| TrainerError::System { what: "threads", problem: error.to_string() })?;
    let silent = arguments.output.quiet || arguments.output.json;
    let progress = Progress::over_cases(found.len() as u64, silent);
    let folder = RunFolder::open(answers);
    let fates: Vec<Option<Fate>> = pool.install(|| {
        found
            .par_iter()
            .map(|case| {
                if cancel.is_requested() {
                    return None;
                }
                let fate = fate(arguments, case, &folder);
                if let Fate::Failed(failed) = &fate {
                    progress.aside(|| console::error(&format!("{}: {}", failed.id, failed.message)));
                }
                progress.one_of_many_done();
                Some(fate)
            })
            .collect()
    });
    progress.finish();
    let complete = fates.iter().all(Option::is_some);
    let (mut diagnosed, mut skipped, mut failed) = (0, 0, Vec::new());
    for fate in fates.into_iter().flatten() {
        match fate {
            Fate::Diagnosed => diagnosed += 1,
            Fate::Skipped => skipped += 1,
            Fate::Failed(case) => failed.push(case),
        }
    }
    let result = BatchResult {
        schema: RESULT_SCHEMA.to_owned(),
        task: "diagnose-batch".to_owned(),
        cases: found.len(),
        diagnosed,
        skipped,
        failed,
        complete,
        seconds: start.elapsed().as_secs_f64(),
    };
    arguments.output.print(&result, || summary(&result, answers))?;
    Ok(match (result.complete, result.failed.is_empty()) {
        (false, _) => Outcome::Interrupted,
        (true, false) => Outcome::CheckFailed,
        (true, true) => Outcome::Done,
    })
}

fn fate(arguments: &DiagnoseArguments, case: &Case, folder: &RunFolder) -> Fate {
    let name = format!("{}/diagnosis.json", case.id);
    let failed =
        |error: TrainerError| Fate::Failed(FailedCase { id: case.id.clone(), message: error.to_string() });
    let answer = folder.path().join(&name);
    if answer.exists() {
        return kept::check_answer(&answer, &case.records, &case.nominal)
            .map_or_else(failed, |()| Fate::Skipped);
    }
    let answered = Question::read(&case.records, &case.nominal, &arguments.reading.plain())
        .and_then(|question| question.answer(&settings(arguments), arguments.seed))
        .map_err(TrainerError::from)
        .and_then(|answer| Ok(folder.write_json(&name, &answer.result)?));
    answered.map_or_else(failed, |()| Fate::Diagnosed)
}

/// The cases in the order of their names. A folder without a record is a case too: its failure says what is missing.
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
