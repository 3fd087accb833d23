//! Tests that estimates come from the envelope alone, without access to the oracle or the truth.

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

/// Steps after which a fit ends: a leak would show in the first steps. Tests with whole fits run on request.
const FEW_STEPS: Option<u64> = Some(5);

/// Methods, each with the bits of its λ.
type Bits = Vec<(String, u64)>;

/// Returns λ of every learned method from a comparison.
fn compared(record: &Path, max_steps: Option<u64>) -> Bits {
    let methods = ESTIMATORS.iter().map(|entry| entry.id).collect::<Vec<_>>().join(",");
    let mut overrides = vec![format!("compare.methods={methods}"), format!("data.path={}", record.display())];
    overrides.extend(max_steps.map(|steps| format!("fit.max_steps={steps}")));
    let arguments: Vec<&str> =
        std::iter::once("configs/compare.toml").chain(overrides.iter().map(String::as_str)).collect();
    let (_, found, _) = result(&arguments);
    let rate = |row: &Value| row["outcome"]["estimate"]["decay_rate"].as_f64().unwrap().to_bits();
    let rows = found["results"].as_array().unwrap();
    rows.iter().map(|row| (row["id"].as_str().unwrap().to_owned(), rate(row))).collect()
}

/// Returns the same for the shipped record, whose origin and truth are stated.
fn shipped() -> &'static Bits {
    static FOUND: LazyLock<Bits> = LazyLock::new(|| compared(&shipped_record(), FEW_STEPS));
    &FOUND
}

fn shipped_record() -> PathBuf {
    root().join("experiments/default-record/record.csv")
}

/// Returns λ of every method in `found`, fitted directly to the shipped record without a call of the oracle.
fn without_an_oracle(found: &Bits, max_steps: Option<u64>) -> Bits {
    let envelope = envelope(&shipped_record());
    let fitted = |(id, _): &(String, u64)| {
        let entry = ESTIMATORS.iter().find(|entry| entry.id == id).unwrap();
        let fields = Section { name: "estimator", fields: entry.fields };
        let settings = Resolved::new(&Document::default(), &[fields]).unwrap();
        let cancel = Cancel::new();
        let context = FitContext::new(Seed::new(0).child(entry.id), max_steps, &Silent, &cancel);
        let estimate = (entry.build)(&settings).unwrap().fit(&envelope, &context).unwrap();
        (id.clone(), estimate.decay_rate.to_bits())
    };
    found.iter().map(fitted).collect()
}

/// Returns λ for the samples of the shipped record in a file of another name that states another origin,
/// beside a false truth.
fn behind_another_truth(max_steps: Option<u64>) -> Bits {
    let text = std::fs::read_to_string(shipped_record()).unwrap();
    assert!(text.contains("# origin: simulated"));
    let folder = tempfile::tempdir().unwrap();
    let other = folder.path().join("decay-rate-0.5.csv");
    std::fs::write(&other, text.replace("# origin: simulated", "# origin: measured")).unwrap();
    std::fs::write(folder.path().join("truth.json"), r#"{"decay_rate": 0.5}"#).unwrap();
    compared(&other, max_steps)
}

/// Poison test: the program calls the oracle first, and without the oracle its estimates are the same to the
/// bit.
#[test]
fn without_an_oracle_every_estimate_is_the_same_to_the_bit() {
    assert_eq!(&without_an_oracle(shipped(), FEW_STEPS), shipped());
}

/// Canary test: a false truth changes nothing.
#[test]
fn another_truth_behind_the_record_changes_no_bit() {
    assert_eq!(&behind_another_truth(FEW_STEPS), shipped());
}

/// `cargo test -p trainer --test acceptance honesty::whole_fits -- --ignored`
#[test]
#[ignore = "whole fits of every method, three times, take minutes"]
fn whole_fits_have_no_way_in_either() {
    let found = compared(&shipped_record(), None);
    assert_eq!(without_an_oracle(&found, None), found);
    assert_eq!(behind_another_truth(None), found);
}

/// The same for a record simulated by the program: with its sealed truth beside it, then with a false one.
#[test]
fn a_falsified_seal_behind_a_simulated_record_changes_no_bit() {
    let (_, folder) = simulate(&["configs/default-record.toml", "seed=5", "record.seconds=20"]);
    let record = folder.path().join("records/record-000.csv");
    let before = compared(&record, FEW_STEPS);
    let truth = folder.path().join("truth/record-000.json");
    let text = std::fs::read_to_string(&truth).unwrap();
    let falsified = text.replace("\"damping\": 0.00011", "\"damping\": 0.11");
    assert_ne!(falsified, text);
    std::fs::write(&truth, &falsified).unwrap();
    std::fs::write(folder.path().join("records/truth.json"), &falsified).unwrap();
    assert_eq!(compared(&record, FEW_STEPS), before);
    std::fs::remove_dir_all(folder.path().join("truth")).unwrap();
    assert_eq!(compared(&record, FEW_STEPS), before);
}
