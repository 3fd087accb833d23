//! First look at the dropped logs.

use crate::host::Answered;
use crate::picture::pictures;
use crate::reading::{experiment, reading};
use experiment::EnvelopeSettings;
use report::format::{percent, with_uncertainty};
use report::in_fields;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use workflow::look::Looked;
use workflow::{Log, guess, mode_rows};

/// Ratio of two natural frequencies from which logs hardly come from one system: an added mass or another amplitude moves
/// a frequency by less.
const ANOTHER_SYSTEM: f64 = 1.25;

/// Request to look at the logs.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LookRequest {
    /// Options of the form.
    reading: Map<String, Value>,
}

/// Looks at each log: what was found, or why it cannot be read.
pub(crate) fn looked(logs: &[Log], request: &LookRequest) -> Answered {
    let (reading, experiment) = (reading(&request.reading)?, experiment(&request.reading)?);
    let looks: Vec<_> = logs.iter().map(|log| (log, Looked::of(log, &reading))).collect();
    let read = looks.iter().filter_map(|(log, found)| Some((*log, found.as_ref().ok()?)));
    let error = |found: &Looked| found.oscillator.damping.std_error;
    let surest = read.min_by(|(_, one), (_, other)| error(one).total_cmp(&error(other)));
    let found: Vec<Value> = looks
        .iter()
        .map(|(log, found)| match found {
            Ok(found) => shown(log, found, surest, &experiment.envelope),
            Err(error) => {
                json!({ "name": log.name, "error": in_fields(&error.to_string()), "titles": titles(log) })
            }
        })
        .collect();
    Ok(json!({ "logs": found }))
}

/// Returns the titles of a table; none for a file that is not one, or that has no columns with titles.
fn titles(log: &Log) -> Vec<String> {
    record::titles(&log.name, &log.bytes).map(|found| found.titles).unwrap_or_default()
}

/// Says why a log hardly comes from the system of the surest one.
fn apart(found: &Looked, surest: Option<(&Log, &Looked)>) -> Option<String> {
    let (log, other) = surest?;
    let [own, others] = [found, other].map(|found| found.look.source.reading.coordinate);
    if own != others {
        let [own, others] = [found, other].map(|found| found.look.record.unit());
        return Some(format!(
            "It is recorded in {own}, and {} in {others}: one system has one coordinate.",
            log.name
        ));
    }
    let [own, others] =
        [found, other].map(|found| found.oscillator.natural_frequency_hz().map(|found| found.value));
    let (own, others) = own.zip(others)?;
    (own.max(others) > ANOTHER_SYSTEM * own.min(others)).then(|| {
        format!("It swings at {own:.4} Hz, and {} at {others:.4} Hz: do they come from one system?", log.name)
    })
}

fn shown(log: &Log, found: &Looked, surest: Option<(&Log, &Looked)>, settings: &EnvelopeSettings) -> Value {
    let decay = settings.extract(settings.pipeline, &found.look.record, &found.look.clock).ok();
    let remarks = found.remarks(decay.as_ref().map(|decay| &decay.envelope));
    let findings = found.findings().into_iter().chain(remarks);
    let findings: Vec<String> = findings.map(|finding| in_fields(&finding)).collect();
    let told = |estimated: Option<identify::Estimated>| {
        estimated.map(|estimated| with_uncertainty(estimated.value, estimated.std_error))
    };
    let number = found.oscillator;
    let modes = mode_rows(&found.modes);
    let modes = modes.iter().map(|mode| {
        let [frequency, ratio] = [&mode.frequency_hz, &mode.damping_ratio]
            .map(|number| with_uncertainty(number.value, number.std_error()));
        let ratio = if mode.steady { "none: a steady line".to_owned() } else { ratio };
        [frequency, ratio, percent(100.0 * mode.share)]
    });
    json!({
        "name": log.name,
        "titles": titles(log),
        "found": found.json(&findings),
        "frequency": told(number.natural_frequency_hz()),
        "ratio": told(number.damping_ratio()),
        "swings": found.swings(),
        "uncertainty": number.damping.std_error,
        "modes": modes.collect::<Vec<_>>(),
        "apart": apart(found, surest),
        "diagnosable": found.is_diagnosable(),
        "without_input": found.without_input,
        "nominal": guess::nominal_toml(&log.name, &found.oscillator, &found.look.source.reading),
        "pictures": pictures(found),
    })
}
