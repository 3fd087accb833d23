//! Creation of cases: the diagnosis's input is written to disk, truths stay sealed in memory.

use super::arguments::TrialsArguments;
use super::each::each;
use super::files::{FULL, MANIFEST, WITHOUT, case_name, text};
use crate::error::TrainerError;
use crate::error::TrialsError;
use crate::terminal::progress::Progress;
use estimator::Cancel;
use rayon::ThreadPool;
use results::{LeftOutBank, TRIALS_MANIFEST_SCHEMA, TrialsManifest, TrialsManifestLine};
use runs::RunFolder;
use serde_json::json;
use std::collections::BTreeMap;
use trials::{Case, Hidden, TrialPlan};
use truth::{Sealed, digest};

/// All cases: their published manifest and their sealed truths, in the same order.
pub(crate) struct Made {
    pub(crate) manifest: TrialsManifest,
    pub(crate) sealed: Vec<Sealed<Hidden>>,
}

/// Creates every case; `None` if interrupted. The manifest is on disk when this returns.
pub(crate) fn make(
    arguments: &TrialsArguments,
    plan: &TrialPlan,
    folder: &RunFolder,
    pool: &ThreadPool,
    cancel: &Cancel,
) -> Result<Option<Made>, TrainerError> {
    let silent = arguments.output.quiet || arguments.output.json;
    let progress = Progress::over(plan.len() as u64, "cases made", silent);
    let file = arguments.config.as_ref().map(|path| path.display().to_string()).unwrap_or_default();
    let numbers: Vec<usize> = (0..plan.len()).collect();
    let made = each(&numbers, pool, cancel, &progress, |&number| {
        let failed = |source| TrialsError::Case { file: file.clone(), number, source };
        write(folder, &plan.case(number).map_err(failed)?)
    })?;
    let Some(made) = made else { return Ok(None) };
    let (cases, sealed) = made.into_iter().unzip();
    let manifest = TrialsManifest {
        schema: TRIALS_MANIFEST_SCHEMA.to_owned(),
        name: plan.name.clone(),
        seed: plan.seed,
        config_digest: digest(&plan.resolved.to_toml()),
        left_out: left_out(plan),
        cases,
    };
    match read_manifest(folder)? {
        Some(published) => compare(folder, &published, &manifest)?,
        None => {
            folder.write_json(MANIFEST, &manifest)?;
            folder.record_event("sealed", &json!({ "truths": manifest.cases.len() }))?;
        }
    }
    Ok(Some(Made { manifest, sealed }))
}

fn write(folder: &RunFolder, case: &Case) -> Result<(TrialsManifestLine, Sealed<Hidden>), TrainerError> {
    let group = case.without.as_ref().map_or_else(|| FULL.to_owned(), |id| format!("{WITHOUT}{id}"));
    let seal = |source| TrialsError::Seal { file: case.id.clone(), source };
    let sealed = Sealed::seal(&case.hidden).map_err(seal)?;
    let records = case.records.iter().enumerate();
    let mut texts: Vec<(String, &String)> =
        records.map(|(number, text)| (format!("record-{number:03}.csv"), text)).collect();
    texts.push(("nominal.toml".to_owned(), &case.nominal));
    let mut files = BTreeMap::new();
    for (name, text) in texts {
        folder.write_reproducible(&case_name(&group, &case.id, &name), text.as_bytes())?;
        files.insert(name, digest(text));
    }
    let truth_digest = sealed.digest().to_owned();
    Ok((TrialsManifestLine { id: case.id.clone(), group, truth_digest, files }, sealed))
}

/// Reads the manifest of a folder; `None` if there is none yet.
pub(crate) fn read_manifest(folder: &RunFolder) -> Result<Option<TrialsManifest>, TrialsError> {
    if !folder.path().join(MANIFEST).exists() {
        return Ok(None);
    }
    let text = text(folder, MANIFEST)?;
    serde_json::from_str(&text).map(Some).map_err(|error| TrialsError::Unreadable {
        file: folder.path().join(MANIFEST).display().to_string(),
        problem: error.to_string(),
    })
}

/// Checks that the recreated cases equal the published ones.
fn compare(
    folder: &RunFolder,
    published: &TrialsManifest,
    again: &TrialsManifest,
) -> Result<(), TrialsError> {
    let file = folder.path().join(MANIFEST).display().to_string();
    let remedy = "the manifest was changed, or the program that makes cases is another one: begin new trials with another \
                  --out";
    let otherwise = |id: &str, stated: &str, found: &str| TrialsError::MadeOtherwise {
        file: file.clone(),
        id: id.to_owned(),
        stated: stated.to_owned(),
        found: found.to_owned(),
        remedy,
    };
    if published.cases.len() != again.cases.len() {
        let count = |manifest: &TrialsManifest| format!("{} cases", manifest.cases.len());
        return Err(otherwise("count", &count(published), &count(again)));
    }
    for (old, new) in published.cases.iter().zip(&again.cases) {
        if old == new {
            continue;
        }
        let changed = old.files.iter().find(|(name, digest)| new.files.get(*name) != Some(digest));
        return Err(match changed {
            Some((name, digest)) => {
                let found = new.files.get(name).map_or("no such file", String::as_str);
                otherwise(&format!("{}/{name}", old.id), digest, found)
            }
            None => otherwise(&old.id, &old.truth_digest, &new.truth_digest),
        });
    }
    Ok(())
}

/// Lists the banks that were asked for and not created, in the form of the manifest.
fn left_out(plan: &TrialPlan) -> Vec<LeftOutBank> {
    plan.left_out_banks()
        .iter()
        .map(|left| LeftOutBank { bank: left.bank.name().to_owned(), reason: left.reason.clone() })
        .collect()
}
