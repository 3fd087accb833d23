//! Estimates come from the envelope alone: no oracle and no truth has a way in.

use crate::simulation::simulate;
use crate::support::{result, root};
use envelope::{Envelope, RecommendedPipeline};
use estimator::{Cancel, FitContext, Silent};
use record::{Clock, ClockChoice, ReadOptions, read_file};
use registry::ESTIMATORS;
use seed::Seed;
use serde_json::Value;
use settings::{Document, Resolved, Section};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

fn section<T: serde::de::DeserializeOwned>(section: Section<'_>) -> T {
    Resolved::new(&Document::default(), &[section]).unwrap().section(section.name).unwrap()
}

fn envelope(record: &Path) -> Envelope {
    let (record, _) = read_file(record, &ReadOptions::default()).unwrap();
    let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
    let recommended =
        experiment::SECTIONS.iter().find(|section| section.name == "envelope.recommended").unwrap();
    section::<RecommendedPipeline>(*recommended).extract(&record, &clock).unwrap().envelope
}

/// Steps after which a fit ends: what has a way in shows in the first of them.
const FEW_STEPS: u64 = 20;

/// λ of every learned method as a comparison writes it.
fn compared(record: &Path) -> Vec<(String, u64)> {
    let methods = ESTIMATORS.iter().map(|entry| entry.id).collect::<Vec<_>>().join(",");
    let (_, found, _) = result(&[
        "configs/compare.toml",
        &format!("compare.methods={methods}"),
        &format!("data.path={}", record.display()),
        &format!("fit.max_steps={FEW_STEPS}"),
    ]);
    let rate = |row: &Value| row["outcome"]["estimate"]["decay_rate"].as_f64().unwrap().to_bits();
    let rows = found["results"].as_array().unwrap();
    rows.iter().map(|row| (row["id"].as_str().unwrap().to_owned(), rate(row))).collect()
}

/// The same of the shipped record, whose origin and truth are stated.
fn shipped() -> &'static [(String, u64)] {
    static FOUND: LazyLock<Vec<(String, u64)>> = LazyLock::new(|| compared(&shipped_record()));
    &FOUND
}

fn shipped_record() -> PathBuf {
    root().join("experiments/default-record/record.csv")
}

/// The poison: here every method is fitted where nobody has asked the oracle anything. What the program
/// finds, which asks it first, is the same to the bit.
#[test]
fn without_an_oracle_every_estimate_is_the_same_to_the_bit() {
    let envelope = envelope(&shipped_record());
    for (id, found) in shipped() {
        let entry = ESTIMATORS.iter().find(|entry| entry.id == id).unwrap();
        let fields = Section { name: "estimator", fields: entry.fields };
        let settings = Resolved::new(&Document::default(), &[fields]).unwrap();
        let cancel = Cancel::new();
        let context = FitContext::new(Seed::new(0).child(entry.id), Some(FEW_STEPS), &Silent, &cancel);
        let estimate = (entry.build)(&settings).unwrap().fit(&envelope, &context).unwrap();
        assert_eq!(estimate.decay_rate.to_bits(), *found, "{id}");
    }
}

/// The canary: the same samples in a file of another name, that states another origin, beside a truth that
/// is false.
#[test]
fn another_truth_behind_the_record_changes_no_bit() {
    let text = std::fs::read_to_string(shipped_record()).unwrap();
    assert!(text.contains("# origin: simulated"));
    let folder = tempfile::tempdir().unwrap();
    let other = folder.path().join("decay-rate-0.5.csv");
    std::fs::write(&other, text.replace("# origin: simulated", "# origin: measured")).unwrap();
    std::fs::write(folder.path().join("truth.json"), r#"{"decay_rate": 0.5}"#).unwrap();
    assert_eq!(compared(&other), shipped());
}

/// The same with a record of the program's own making: its sealed truth beside it, then a false one.
#[test]
fn a_falsified_seal_behind_a_simulated_record_changes_no_bit() {
    let (_, folder) = simulate(&["configs/default-record.toml", "seed=5", "record.seconds=20"]);
    let record = folder.path().join("records/record-000.csv");
    let before = compared(&record);
    let truth = folder.path().join("truth/record-000.json");
    let text = std::fs::read_to_string(&truth).unwrap();
    let falsified = text.replace("\"damping\": 0.00011", "\"damping\": 0.11");
    assert_ne!(falsified, text);
    std::fs::write(&truth, &falsified).unwrap();
    std::fs::write(folder.path().join("records/truth.json"), &falsified).unwrap();
    assert_eq!(compared(&record), before);
    std::fs::remove_dir_all(folder.path().join("truth")).unwrap();
    assert_eq!(compared(&record), before);
}
