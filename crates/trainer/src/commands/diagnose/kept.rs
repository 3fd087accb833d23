//! Stored diagnoses: reading and checking a folder for `--resume` and for the answers of a batch.

use super::arguments::DiagnoseArguments;
use crate::error::{KeptError, TrainerError};
use crate::folders::environment::Environment;
use crate::folders::page::write_report;
use record::file_digest;
use results::{CaseFile, DiagnosisResult};
use runs::{RunError, RunFolder};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use workflow::{Answer, Question, nominal};

/// Event that records the question; it is written before the diagnosis itself.
const ASKED: &str = "start";
/// File that records the question of a batch's answer, beside the answer.
pub(super) const CASE_FILE: &str = "case.json";
/// Event that marks a complete diagnosis.
pub(super) const END: &str = "end";

/// Returns everything that an answer depends on, except for the program; long parts are given as digests.
pub(super) fn asked(arguments: &DiagnoseArguments, question: &Question) -> Value {
    let records: Vec<&str> = question.given.iter().map(|given| given.row.digest.as_str()).collect();
    asked_of(arguments, &records, &nominal::digest(&question.stated))
}

/// Builds the value of [`asked`] from the digests of records and simulator.
fn asked_of(arguments: &DiagnoseArguments, records: &[&str], nominal: &str) -> Value {
    json!({
        "records": records,
        "nominal": nominal,
        "reading": arguments.reading,
        "most_effects": arguments.most_effects,
        "without": arguments.without,
        "false_alarm": arguments.false_alarm,
        "seed": arguments.seed,
    })
}

/// Writes the run folder of an answer, with the report last.
pub(super) fn keep(
    folder: &RunFolder,
    question: &Question,
    asked: &Value,
    answer: &Answer,
    threads: usize,
) -> Result<(), TrainerError> {
    folder.write_json("environment.json", &Environment::new(threads, &question.digests()))?;
    folder.write("nominal.toml", export::nominal_text(&question.stated.simulator).as_bytes())?;
    folder.record_event(ASKED, asked)?;
    for (name, text) in answer.files()? {
        folder.write(name, text.as_bytes())?;
    }
    write_report(folder)?;
    folder.record_event(END, &json!({ "status": answer.result.verdict.status }))?;
    Ok(())
}

/// Reads the finished answer to a question from a folder; `None` if the diagnosis was interrupted or the
/// folder is empty.
///
/// # Errors
/// [`RunError::Occupied`] if the folder holds anything else; [`KeptError`] if it holds the answer to another
/// question.
pub(super) fn finished(folder: &RunFolder, asked: &Value) -> Result<Option<DiagnosisResult>, TrainerError> {
    let path = folder.path();
    let log = folder.events()?;
    let Some(begun) = log.last(ASKED) else {
        let left = folder.holds_only(&["nominal.toml", "environment.json", "events.jsonl"])?;
        return if left { Ok(None) } else { Err(RunError::Occupied { path: path.to_owned() }.into()) };
    };
    same(path, &begun.details, asked)?;
    if log.last(END).is_none() {
        return Ok(None);
    }
    let bytes = folder.read("diagnosis.json")?;
    let kept = serde_json::from_slice(&bytes).map_err(|error| KeptError::NoDiagnosis {
        answer: path.join("diagnosis.json").display().to_string(),
        problem: error.to_string(),
    })?;
    Ok(Some(kept))
}

fn same(folder: &Path, kept: &Value, asked: &Value) -> Result<(), KeptError> {
    let different = asked.as_object().into_iter().flatten().find(|(key, value)| kept.get(key) != Some(value));
    let Some((key, value)) = different else { return Ok(()) };
    Err(KeptError::AnotherQuestion {
        folder: folder.display().to_string(),
        what: key.replace('_', " "),
        kept: kept.get(key).unwrap_or(&Value::Null).to_string(),
        asked: value.to_string(),
    })
}

/// Returns the question as [`asked`] does, with the version of the program. An answer of a batch whose case
/// file holds the same value is not computed again.
pub(super) fn asked_by_batch(arguments: &DiagnoseArguments, question: &Question) -> Value {
    with_version(asked(arguments, question))
}

fn with_version(mut asked: Value) -> Value {
    if let Some(fields) = asked.as_object_mut() {
        fields.insert("version".to_owned(), env!("CARGO_PKG_VERSION").into());
    }
    asked
}

/// Checks that an answer of a batch was computed with these options and by this version; answers without a
/// case file are accepted.
fn check_asked(
    arguments: &DiagnoseArguments,
    answer: &Path,
    records: &[&str],
    nominal: &str,
) -> Result<(), KeptError> {
    let Some(folder) = answer.parent() else { return Ok(()) };
    let path = folder.join(CASE_FILE);
    let Ok(bytes) = std::fs::read(&path) else { return Ok(()) };
    let case: CaseFile = serde_json::from_slice(&bytes).map_err(|error| KeptError::NoDiagnosis {
        answer: path.display().to_string(),
        problem: error.to_string(),
    })?;
    same(folder, &case.asked, &with_version(asked_of(arguments, records, nominal)))
}

/// Checks that an answer of a batch belongs to the case's present records and nominal simulator. Digests that
/// the answer does not state are not compared.
pub(super) fn check_answer(
    arguments: &DiagnoseArguments,
    answer: &Path,
    records: &[PathBuf],
    path: &Path,
) -> Result<(), TrainerError> {
    let shown = || answer.display().to_string();
    let unusable = |problem: String| KeptError::NoDiagnosis { answer: shown(), problem };
    let bytes = std::fs::read(answer).map_err(|error| unusable(error.to_string()))?;
    let found: Value = serde_json::from_slice(&bytes).map_err(|error| unusable(error.to_string()))?;
    let stated = nominal::digest(&nominal::read(path)?);
    let kept = found.get("nominal_digest").and_then(Value::as_str).filter(|digest| !digest.is_empty());
    if let Some(kept) = kept {
        let found = stated.clone();
        if found != kept {
            let (nominal, kept) = (path.display().to_string(), kept.to_owned());
            return Err(KeptError::AnotherNominal { nominal, answer: shown(), kept, found }.into());
        }
    }
    let Some(rows) = found.get("records").and_then(Value::as_array) else { return Ok(()) };
    let kept: Vec<&str> = rows.iter().filter_map(|row| row.get("digest")).filter_map(Value::as_str).collect();
    let none = "none, there was no such record";
    for (at, record) in records.iter().enumerate() {
        let (found, kept) = (file_digest(record)?, kept.get(at).copied().unwrap_or(none));
        if found != kept {
            let record = record.display().to_string();
            let kept = kept.to_owned();
            return Err(KeptError::AnotherRecord { record, answer: shown(), kept, found }.into());
        }
    }
    match kept.get(records.len()) {
        None => Ok(check_asked(arguments, answer, &kept, &stated)?),
        Some(kept) => Err(KeptError::AnotherRecord {
            record: format!("record {}", records.len() + 1),
            answer: shown(),
            kept: (*kept).to_owned(),
            found: "none, it is gone".to_owned(),
        }
        .into()),
    }
}
