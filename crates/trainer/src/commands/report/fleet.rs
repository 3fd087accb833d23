//! Report on a fleet: the answers of a batch in one page.

use super::outliers::outliers;
use crate::commands::diagnose::batch::{ANSWER, FAILED};
use crate::error::TrainerError;
use record::Origin;
use report::{RunTexts, render, verdict_sentence};
use results::{
    CaseFile, DiagnosisResult, FLEET_SCHEMA, FailedCase, FleetCase, FleetClass, FleetGroup, FleetNumber,
    FleetResult,
};
use runs::{RunError, RunFolder, to_json};
use scoring::median;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Files that show that a folder is something other than the answers of a batch.
const OTHERS: [&str; 4] = [ANSWER, "result.json", "rigs.json", "sweep.json"];
/// Labels that come first.
const FIRST: [&str; 3] = ["robot", "joint", "date"];
/// Probability from which a class counts as likely.
const LIKELY: f64 = 0.5;
/// Probability from which a class counts as certain.
const CERTAIN: f64 = 0.9;

/// Returns `true` if a folder holds answers of a batch, or reasons why there are none.
pub(super) fn is_one(path: &Path) -> bool {
    let is_other = OTHERS.iter().any(|name| path.join(name).exists());
    !is_other && folders(path).iter().any(|case| case.join(ANSWER).is_file() || case.join(FAILED).is_file())
}

/// Writes `fleet.json` and `report.html` from the answers in the subfolders of a folder.
pub(super) fn write(folder: &RunFolder) -> Result<(), TrainerError> {
    let result = fleet(folder.path());
    let text = to_json("fleet.json", &result)?;
    folder.write("fleet.json", text.as_bytes())?;
    let name = folder.path().canonicalize().map_err(|source| RunError::Io {
        path: folder.path().to_owned(),
        action: "find",
        source,
    })?;
    let name = name.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let html = render(&RunTexts { name: &name, result: &text, ..RunTexts::default() })?;
    folder.write("report.html", html.as_bytes())?;
    Ok(())
}

/// Returns the subfolders of a folder, sorted by name.
fn folders(path: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
    let mut found: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    found.sort();
    found
}

fn fleet(path: &Path) -> FleetResult {
    let (mut cases, mut failed, mut shares) = (Vec::new(), Vec::new(), BTreeMap::<String, Vec<f64>>::new());
    for folder in folders(path) {
        let id = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        match answer(&folder) {
            None => {}
            Some(Err(message)) => failed.push(FailedCase { id, message }),
            Some(Ok(answer)) => {
                for class in answer.classes.iter().filter(|class| class.probability >= LIKELY) {
                    let share = class.gap_share.map(|share| share.value).filter(|share| share.is_finite());
                    shares.entry(class.id.clone()).or_default().extend(share);
                }
                cases.push(case(id, labels(&folder), &answer));
            }
        }
    }
    let all: BTreeSet<&String> = cases.iter().flat_map(|case| case.labels.keys()).collect();
    let first = FIRST.iter().map(|name| (*name).to_owned()).filter(|name| all.contains(name));
    let rest = all.iter().map(|name| (*name).clone()).filter(|name| !FIRST.contains(&name.as_str()));
    let labels: Vec<String> = first.chain(rest).collect();
    FleetResult {
        schema: FLEET_SCHEMA.to_owned(),
        task: "fleet".to_owned(),
        classes: classes(&cases, &shares),
        groups: labels.iter().flat_map(|label| groups(&cases, label)).collect(),
        outliers: outliers(&cases),
        labels,
        cases,
        failed,
    }
}

/// Reads the answer in a case's folder, or the reason why there is none; `None` if the folder is not a case.
/// An unreadable answer is a failure of its case, not of the report.
fn answer(folder: &Path) -> Option<Result<DiagnosisResult, String>> {
    let path = folder.join(ANSWER);
    if path.is_file() {
        let unreadable = |problem: String| format!("{}: is not a diagnosis: {problem}", path.display());
        let bytes = std::fs::read(&path).map_err(|error| unreadable(error.to_string()));
        return Some(bytes.and_then(|bytes| {
            serde_json::from_slice(&bytes).map_err(|error| unreadable(error.to_string()))
        }));
    }
    let bytes = std::fs::read(folder.join(FAILED)).ok()?;
    let failed: Option<FailedCase> = serde_json::from_slice(&bytes).ok();
    Some(Err(failed.map_or_else(|| format!("{FAILED} cannot be read"), |failed| failed.message)))
}

/// Reads the labels of a case; empty if its answer comes from a version that stored none.
fn labels(folder: &Path) -> BTreeMap<String, String> {
    let bytes = std::fs::read(folder.join("case.json")).unwrap_or_default();
    serde_json::from_slice(&bytes).map(|file: CaseFile| file.labels).unwrap_or_default()
}

fn case(id: String, labels: BTreeMap<String, String>, answer: &DiagnosisResult) -> FleetCase {
    FleetCase {
        id,
        labels,
        origin: Origin::shared(answer.records.iter().map(|record| record.origin)),
        status: answer.verdict.status,
        classes: answer.classes.iter().map(|class| (class.id.clone(), class.probability)).collect(),
        summary: verdict_sentence(answer),
        numbers: numbers(answer),
    }
}

/// Returns the numbers of a case that can be compared with those of other cases.
fn numbers(answer: &DiagnosisResult) -> BTreeMap<String, FleetNumber> {
    let ratio = |name: &str, value: f64| (name.to_owned(), value, String::new());
    let mut all = vec![
        ratio(FleetNumber::OVER_NOISE, answer.gap.ratio_to_floor),
        ratio(FleetNumber::CLOSURE, answer.gap.closure.value),
    ];
    all.extend(answer.left_over.as_ref().map(|left| ratio(FleetNumber::NAMELESS, left.share_of_gap)));
    for (name, row) in answer.calibration.rows() {
        let value = row.repaired.or(row.recalibrated).filter(|_| row.determined != Some(false));
        all.extend(value.map(|value| (name, value.value, row.unit.clone())));
    }
    for effect in answer.effects.iter().filter(|effect| answer.verdict.effects.contains(&effect.id)) {
        for (name, row) in effect.parameters.iter().filter(|(_, row)| row.determined) {
            all.push((format!("{}.{name}", effect.id), row.value, row.unit.clone()));
        }
    }
    let finite = all.into_iter().filter(|(_, value, _)| value.is_finite());
    finite.map(|(name, value, unit)| (name, FleetNumber { value, unit })).collect()
}

fn classes(cases: &[FleetCase], shares: &BTreeMap<String, Vec<f64>>) -> Vec<FleetClass> {
    let ids: BTreeSet<&String> = cases.iter().flat_map(|case| case.classes.keys()).collect();
    let above = |id: &String, least: f64| {
        cases
            .iter()
            .filter(|case| case.classes.get(id).is_some_and(|probability| *probability >= least))
            .count()
    };
    let of = |id: &String| FleetClass {
        id: id.clone(),
        likely: above(id, LIKELY),
        certain: above(id, CERTAIN),
        gap_share: shares.get(id).filter(|own| !own.is_empty()).map(|own| median(own.iter().copied())),
    };
    let mut found: Vec<FleetClass> = ids.into_iter().map(of).collect();
    found.sort_by_key(|class| (std::cmp::Reverse(class.likely), std::cmp::Reverse(class.certain)));
    found
}

/// Groups the cases by the values of a label.
fn groups(cases: &[FleetCase], label: &str) -> Vec<FleetGroup> {
    let mut groups: BTreeMap<&String, FleetGroup> = BTreeMap::new();
    for case in cases {
        let Some(value) = case.labels.get(label) else { continue };
        let group = groups.entry(value).or_insert_with(|| FleetGroup {
            label: label.to_owned(),
            value: value.clone(),
            cases: 0,
            likely: BTreeMap::new(),
        });
        group.cases += 1;
        for (id, _) in case.classes.iter().filter(|(_, probability)| **probability >= LIKELY) {
            *group.likely.entry(id.clone()).or_default() += 1;
        }
    }
    groups.into_values().collect()
}
