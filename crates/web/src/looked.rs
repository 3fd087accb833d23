//! First look at the dropped logs.

use crate::host::Answered;
use crate::picture::picture;
use crate::reading::{experiment, reading};
use experiment::EnvelopeSettings;
use report::format::with_uncertainty;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use workflow::look::Looked;
use workflow::{Log, guess};

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
    let found: Vec<Value> = logs
        .iter()
        .map(|log| match Looked::of(log, &reading) {
            Ok(found) => shown(log, &found, &experiment.envelope),
            Err(error) => {
                json!({ "name": log.name, "error": error.to_string(), "titles": titles(log) })
            }
        })
        .collect();
    Ok(json!({ "logs": found }))
}

/// Returns the titles of a table; none for a file that is not one, or that has no columns with titles.
fn titles(log: &Log) -> Vec<String> {
    record::titles(&log.name, &log.bytes).map(|found| found.titles).unwrap_or_default()
}

fn shown(log: &Log, found: &Looked, settings: &EnvelopeSettings) -> Value {
    let decay = settings.extract(settings.pipeline, &found.look.record, &found.look.clock).ok();
    let remarks = found.remarks(decay.as_ref().map(|decay| &decay.envelope));
    let findings: Vec<String> = found.findings().into_iter().chain(remarks).collect();
    let told = |estimated: Option<identify::Estimated>| {
        estimated.map(|estimated| with_uncertainty(estimated.value, estimated.std_error))
    };
    let number = found.oscillator;
    json!({
        "name": log.name,
        "titles": titles(log),
        "found": found.json(&findings),
        "frequency": told(number.natural_frequency_hz()),
        "ratio": told(number.damping_ratio()),
        "swings": found.swings(),
        "uncertainty": number.damping.std_error,
        "diagnosable": found.is_diagnosable(),
        "without_input": found.without_input,
        "nominal": guess::nominal_toml(&log.name, &found.oscillator, &found.look.source.reading),
        "pictures": picture(&found.look),
    })
}
