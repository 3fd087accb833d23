//! Fuzzing targets: shared by the fuzzer and by the test that replays its findings.
//!
//! Besides not panicking, results have to be consistent: a resolved configuration resolves to itself, and an
//! accepted record has a length.

use envelope::{PaperPipeline, RecommendedPipeline};
use estimator::Entry;
use experiment::{resolve, resolve_nominal, resolve_prediction};
use record::{Clock, ClockChoice, CsvColumns, Format, Quantity, ReadOptions, read_text};
use report::RunTexts;
use settings::{Document, Resolved, SettingsError};
use simulator::Plan;
use std::path::Path;
use trials::TrialPlan;

const CLASSICAL: &[&str] = &["ols", "qr"];

/// Lines that separate the texts of an input.
const BETWEEN: &str = "\n===\n";

type Task = (&'static str, fn(&Document, &[Entry]) -> Result<Resolved, SettingsError>);

const TASKS: [Task; 4] = [
    ("experiment", |document, registry| Ok(resolve(document, registry, CLASSICAL)?.resolved)),
    ("prediction", |document, registry| Ok(resolve_prediction(document, registry, CLASSICAL)?.resolved)),
    ("simulation", |document, _| Ok(Plan::resolve(document)?.resolved)),
    ("trials", |document, _| Ok(TrialPlan::resolve(document)?.resolved)),
];

fn every_task(document: &Document, registry: &[Entry]) {
    for (task, resolve) in TASKS {
        let Ok(resolved) = resolve(document, registry) else { continue };
        let text = resolved.to_toml();
        let again = Document::parse("config.toml", &text)
            .and_then(|document| resolve(&document, registry))
            .unwrap_or_else(|error| panic!("{task}: what is in force is refused: {error}\n{text}"));
        let values = |resolved: &Resolved| -> Vec<_> {
            resolved.settings().iter().map(|setting| (setting.key(), setting.value.clone())).collect()
        };
        assert_eq!(values(&resolved), values(&again), "{task}");
    }
}

/// Resolves a configuration for every task.
pub(crate) fn configuration(data: &[u8], registry: &[Entry]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Ok(document) = Document::parse("fuzz.toml", text) {
        every_task(&document, registry);
    }
}

/// Resolves a configuration with a base file and overrides, one per line.
pub(crate) fn overrides(data: &[u8], registry: &[Entry]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let mut parts = text.split(BETWEEN);
    let (own, below, arguments) = (parts.next(), parts.next(), parts.next());
    let mut read = |_: &Path| below.map(str::to_owned).ok_or_else(|| "no such file".to_owned());
    let document = Document::parse("fuzz.toml", own.unwrap_or_default());
    let Ok(mut document) = document.and_then(|document| document.on_its_bases(&mut read)) else { return };
    for argument in arguments.unwrap_or_default().lines() {
        let _ = document.apply_override(argument);
    }
    every_task(&document, registry);
}

/// Reads a record file with columns, for each quantity.
pub(crate) fn csv(data: &[u8]) {
    let (first, rest) = data.split_first().unwrap_or((&0, &[]));
    let quantity = match first % 3 {
        0 => Quantity::Position,
        1 => Quantity::Velocity,
        _ => Quantity::Acceleration,
    };
    let rate = if first & 0x10 == 0 { None } else { Some(100.0) };
    let columns = CsvColumns { sample_rate_hz: rate, ..CsvColumns::default() };
    record(
        rest,
        &ReadOptions { format: Format::Csv, columns, quantity: Some(quantity), ..ReadOptions::default() },
    );
}

/// Reads a record file of the host-log format.
pub(crate) fn host_log(data: &[u8]) {
    record(data, &ReadOptions { format: Format::HostLog, ..ReadOptions::default() });
}

fn record(data: &[u8], options: &ReadOptions) {
    let Ok((record, source)) = read_text("fuzz", data, options) else { return };
    assert!(!record.is_empty() && record.values().len() == record.stamps_s().len());
    for choice in [ClockChoice::Host, ClockChoice::UniformIndex, ClockChoice::Auto] {
        let Ok(clock) = Clock::new(&record, choice) else { continue };
        let _ = source.statements.contradictions(record.len(), &clock);
        // A grid of millions of points tests no more than one of thousands.
        let span = clock.times_s.last().zip(clock.times_s.first()).map_or(0.0, |(last, first)| last - first);
        let paper = PaperPipeline {
            interpolation_step_s: span / 2000.0,
            smoothing_window: 5,
            smoothing_order: 3,
            late_fraction: 0.2,
            peak_distance: 5,
            prominence: 0.01,
        };
        let recommended = RecommendedPipeline::DEFAULT;
        let _ = paper.extract(&record, &clock);
        let _ = recommended.extract(&record, &clock);
    }
}

/// Reads the nominal simulator of a diagnosis.
pub(crate) fn nominal(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Ok(document) = Document::parse("nominal.toml", text) {
        let _ = resolve_nominal(&document);
    }
}

/// Reads the files of a finished run, as for a report.
pub(crate) fn results(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let mut parts = text.split(BETWEEN).map(str::to_owned);
    let mut next = || parts.next().unwrap_or_default();
    let [result, trace, envelope, predictions, series, environment] = std::array::from_fn(|_| next());
    let _ = report::render(&RunTexts {
        name: "fuzz",
        config: "",
        result: &result,
        trace: &trace,
        envelope: &envelope,
        predictions: &predictions,
        series: &series,
        environment: &environment,
        reader: report::Reader::Page,
    });
}
