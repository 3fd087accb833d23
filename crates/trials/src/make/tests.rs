use super::case::Job;
use super::plan::TrialPlan;
use crate::Bank;
use dynamics::Nominal;
use record::{ReadOptions, read_text};
use settings::Document;
use std::path::Path;

const BANKS: &[&str] =
    &["none", "calibration", "single", "pair", "left_out", "foreign", "releases", "driven", "stressed"];

/// Short records, so that a test makes many.
fn plan(counts: &[(&str, usize)], overrides: &[&str]) -> TrialPlan {
    let mut document = Document::parse("test.toml", "").unwrap();
    let short = ["record.seconds=6", "record.rate_hz=120", "system.lowest_frequency_hz=2"];
    let counts: Vec<String> = counts.iter().map(|(bank, count)| format!("trials.{bank}={count}")).collect();
    for argument in
        short.iter().copied().chain(counts.iter().map(String::as_str)).chain(overrides.iter().copied())
    {
        document.apply_override(argument).unwrap();
    }
    TrialPlan::resolve(&document).unwrap()
}

#[test]
fn every_bank_makes_cases_that_read_back() {
    for seed in ["seed=1", "seed=2"] {
        let counts: Vec<(&str, usize)> = BANKS.iter().map(|bank| (*bank, 4)).collect();
        let plan = plan(&counts, &[seed]);
        assert_eq!(plan.len(), 4 * BANKS.len());
        for index in 0..plan.len() {
            let case = plan.case(index).unwrap();
            assert_eq!(case.id, format!("{index:06}"));
            let nominal: Nominal = toml::from_str(&case.nominal).unwrap();
            assert!(nominal.stiffness() > 0.0);
            for text in &case.records {
                let (record, source) = read_text("record", text.as_bytes(), &ReadOptions::default()).unwrap();
                assert!(record.len() > 300, "{}", record.len());
                assert_eq!(source.findings, Vec::<String>::new());
            }
            let text = serde_json::to_string(&case.hidden).unwrap();
            assert_eq!(serde_json::from_str::<crate::Hidden>(&text).unwrap(), case.hidden);
        }
    }
}

/// `cargo test --release -p trials how_long -- --ignored --nocapture`
#[test]
#[ignore = "minutes without optimization"]
fn how_long_a_hundred_cases_take() {
    let text = std::fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/trials-quick.toml"),
    )
    .unwrap();
    let mut document = Document::parse("trials-quick.toml", &text).unwrap();
    for argument in option_env!("TRIALS").unwrap_or_default().split_whitespace() {
        document.apply_override(argument).unwrap();
    }
    let plan = TrialPlan::resolve(&document).unwrap();
    let mut by_bank = std::collections::BTreeMap::<Bank, (usize, f64, f64)>::new();
    for index in 0..plan.len() {
        let clock = std::time::Instant::now();
        let case = plan.case(index);
        let seconds = clock.elapsed().as_secs_f64();
        let Job { bank, number } = plan.job(index).unwrap();
        let entry = by_bank.entry(bank).or_default();
        *entry = (entry.0 + 1, entry.1 + seconds, entry.2.max(seconds));
        match case {
            Ok(case) => {
                let told: Vec<String> = case
                    .hidden
                    .effects
                    .iter()
                    .map(|e| format!("{} {:?} d {:.3}", e.id, e.parameters, e.detectability))
                    .collect();
                println!(
                    "{bank:?} {number} {seconds:.3} s {} {:?} {:?}",
                    told.join(" + "),
                    case.hidden.foreign,
                    case.hidden.nuisances
                );
            }
            Err(error) => println!("{bank:?} {number} {seconds:.3} s FAILED {error}"),
        }
    }
    for (bank, (count, seconds, worst)) in by_bank {
        println!("{bank:?}: {count} cases, {:.3} s each, worst {worst:.3}", seconds / count as f64);
    }
}
