//! Opening of the seals: truths, answers and records from the folder, each checked against the manifest's
//! digest.

use super::baselines::{DIAGNOSERS, Diagnoser};
use super::each::each;
use super::files::{FAILED, WITHOUT, answer_name, case_name, text, truth_name};
use crate::commands::diagnose::GivenCase;
use crate::diagnose;
use crate::error::TrainerError;
use crate::error::TrialsError;
use crate::terminal::progress::Progress;
use diagnosis::Settings;
use dynamics::REGISTRY;
use estimator::Cancel;
use rayon::ThreadPool;
use results::{DiagnosisResult, TrialsManifest, TrialsManifestLine};
use runs::RunFolder;
use std::collections::BTreeMap;
use trials::{AnsweredCase, Baseline, Hidden, true_closure, with_the_truth};
use truth::{Sealed, digest};

/// Reads the reasons why cases have no answer, by case, as the diagnosis reported them; empty if there is no
/// such file.
pub(crate) fn failed(folder: &RunFolder) -> Result<BTreeMap<String, String>, TrialsError> {
    let path = folder.path().join(FAILED);
    if !path.exists() {
        return Ok(BTreeMap::new());
    }
    serde_json::from_str(&text(folder, FAILED)?).map_err(|error| TrialsError::Unreadable {
        file: path.display().to_string(),
        problem: error.to_string(),
    })
}

/// Cases with opened truths, and the answers of simpler diagnosers.
pub(crate) struct Opened {
    pub(crate) cases: Vec<AnsweredCase>,
    pub(crate) baselines: Vec<Baseline>,
}

/// Effect that each simpler diagnoser names in a case.
type Named = Vec<Option<String>>;

/// Opens every truth and reads every answer; `None` if interrupted. `failed` holds the known reasons why
/// answers are missing.
pub(crate) fn open(
    folder: &RunFolder,
    manifest: &TrialsManifest,
    pool: &ThreadPool,
    failed: &BTreeMap<String, String>,
    (cancel, silent): (&Cancel, bool),
) -> Result<Option<Opened>, TrainerError> {
    let progress = Progress::over(manifest.cases.len() as u64, "cases opened", silent);
    let lines = &manifest.cases;
    let opened = each(lines, pool, cancel, &progress, |line| one(folder, line, failed))?;
    let Some(opened) = opened else { return Ok(None) };
    let (cases, named): (Vec<AnsweredCase>, Vec<Named>) = opened.into_iter().unzip();
    let baseline = |(index, diagnoser): (usize, &Diagnoser)| Baseline {
        id: diagnoser.id.to_owned(),
        method: diagnoser.method.to_owned(),
        answers: named.iter().map(|own| own.get(index).cloned().flatten()).collect(),
    };
    Ok(Some(Opened { baselines: DIAGNOSERS.iter().enumerate().map(baseline).collect(), cases }))
}

fn one(
    folder: &RunFolder,
    line: &TrialsManifestLine,
    failed: &BTreeMap<String, String>,
) -> Result<(AnsweredCase, Named), TrainerError> {
    let shown = |name: &str| folder.path().join(name).display().to_string();
    let name = truth_name(&line.id);
    let sealed = Sealed::<Hidden>::from_stored(text(folder, &name)?, line.truth_digest.clone());
    let hidden = sealed.open().map_err(|source| TrialsError::Seal { file: shown(&name), source })?;
    for (file, stated) in &line.files {
        let name = case_name(&line.group, &line.id, file);
        let found = digest(&text(folder, &name)?);
        if found != *stated {
            return Err(TrialsError::Changed { file: shown(&name), stated: stated.clone(), found }.into());
        }
    }
    let answer = answer(folder, line, failed)?;
    let nominal = folder.path().join(case_name(&line.group, &line.id, "nominal.toml"));
    let records: Vec<_> = line
        .files
        .keys()
        .filter(|file| file.starts_with("record-"))
        .map(|file| folder.path().join(case_name(&line.group, &line.id, file)))
        .collect();
    let (true_closure, error_of_the_truth, named) = match diagnose::given(&records, &nominal) {
        Ok(given) => {
            let closure = match &answer {
                Ok(answer) => true_closure(&hidden, &given.nominal, answer),
                Err(message) => Err(message.clone()),
            };
            let named = DIAGNOSERS.iter().map(|diagnoser| (diagnoser.names)(&given).map(str::to_owned));
            (closure, error_of_the_truth(&hidden, &given), named.collect())
        }
        // A case whose input cannot be read has no answer either.
        Err(error) => (Err(error.to_string()), Err(error.to_string()), Vec::new()),
    };
    let without = line.group.strip_prefix(WITHOUT).map_or_else(String::new, |id| format!(" --without {id}"));
    let paths: Vec<String> = records.iter().map(|path| path.display().to_string()).collect();
    let command = format!("trainer diagnose {} --nominal {}{without}", paths.join(" "), nominal.display());
    let id = line.id.clone();
    Ok((AnsweredCase { id, hidden, answer, true_closure, error_of_the_truth, command }, named))
}

/// Returns the held-out error of the set that is there: the nominal simulator with the truth in it, recalibrated by a
/// diagnosis that may name nothing.
fn error_of_the_truth(hidden: &Hidden, given: &GivenCase) -> Result<f64, String> {
    let simulator = with_the_truth(hidden, &(&given.nominal).into())?;
    let without = REGISTRY.iter().map(|effect| effect.id().to_owned()).collect();
    let settings = Settings { without, ..Settings::default() };
    let found = diagnosis::diagnose(&given.observations, simulator, &settings, &|| 0.0);
    found.map(|found| found.gap.recalibrated).map_err(|error| error.to_string())
}

/// Reads the answer to a case, or the reason why there is none.
fn answer(
    folder: &RunFolder,
    line: &TrialsManifestLine,
    failed: &BTreeMap<String, String>,
) -> Result<Result<DiagnosisResult, String>, TrialsError> {
    let name = answer_name(&line.group, &line.id);
    let path = folder.path().join(&name);
    if !path.exists() {
        let unknown = || "none was given".to_owned();
        return Ok(Err(failed.get(&line.id).cloned().unwrap_or_else(unknown)));
    }
    let file = path.display().to_string();
    let answer: DiagnosisResult = serde_json::from_str(&text(folder, &name)?)
        .map_err(|error| TrialsError::Unreadable { file: file.clone(), problem: error.to_string() })?;
    let found: Vec<&str> = answer.records.iter().map(|record| record.digest.as_str()).collect();
    let stated: Vec<&str> = line
        .files
        .iter()
        .filter(|(file, _)| file.starts_with("record-"))
        .map(|(_, digest)| digest.as_str())
        .collect();
    if found != stated {
        return Err(TrialsError::OtherRecords { file, stated: stated.join(" "), found: found.join(" ") });
    }
    Ok(Ok(answer))
}
