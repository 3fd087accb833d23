//! Estimates of the decay of the dropped logs by least squares and the other methods that need no network.

use crate::host::Answered;
use crate::reading::{experiment, reading};
use estimator::{Cancel, Entry, FitContext, Silent};
use oracle::classical::{CLASSICAL, ClassicalRoute};
use results::{PipelineOutcome, PipelineRow};
use seed::Seed;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use settings::{Document, Resolved, Section};
use workflow::estimate::Input;
use workflow::look::of_decay;
use workflow::read::Loaded;
use workflow::{Log, in_options};

/// Methods of the registry that need neither a network nor random draws.
const IDENTIFYING: [Entry; 3] =
    [estimator_sindy::ENTRY, estimator_weak_sindy::ENTRY, estimator_envelope_matching::ENTRY];

/// Request for estimates.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct EstimateRequest {
    /// Options of the form.
    reading: Map<String, Value>,
}

/// Estimates the decay of each log, with both pipelines and clocks.
pub(crate) fn estimated(logs: &[Log], request: &EstimateRequest) -> Answered {
    let (reading, experiment) = (reading(&request.reading)?, experiment(&request.reading)?);
    let of = |log: &Log| -> Result<Value, String> {
        let loaded = Loaded::parse(&log.name, &log.bytes, &reading).map_err(|error| error.to_string())?;
        let input = Input::of(loaded.record, loaded.source, loaded.clock, &experiment.envelope)
            .map_err(|error| in_options(&error.to_string()))?
            .with_pipelines(&experiment.envelope);
        Ok(json!({
            "name": log.name,
            "pipelines": input.pipelines.iter().map(pipeline).collect::<Vec<_>>(),
            "methods": CLASSICAL
                .iter()
                .map(|route| method(route, &input))
                .chain(IDENTIFYING.iter().map(|entry| identified(entry, &input)))
                .collect::<Vec<_>>(),
            "because": input.extraction.because,
            "remarks": of_decay(&input.record, &input.clock, input.modes.len(), Some(&input.extraction.envelope)),
        }))
    };
    let told = |log: &Log| {
        of(log).unwrap_or_else(|error| json!({ "name": log.name, "error": report::in_fields(&error) }))
    };
    Ok(json!({ "logs": logs.iter().map(told).collect::<Vec<_>>() }))
}

fn pipeline(row: &PipelineRow) -> Value {
    let (pipeline, clock) = (&row.pipeline, &row.clock);
    match &row.outcome {
        PipelineOutcome::Fit { peaks, omega_rad_s, decay_rate, zeta, zeta_std_error, .. } => json!({
            "pipeline": pipeline, "clock": clock, "in_force": row.in_force, "peaks": peaks, "omega_rad_s": omega_rad_s,
            "decay_rate": decay_rate, "zeta": zeta, "zeta_std_error": zeta_std_error,
        }),
        PipelineOutcome::Failed { reason } => {
            json!({ "pipeline": pipeline, "clock": clock, "in_force": row.in_force, "error": reason })
        }
    }
}

fn method(route: &ClassicalRoute, input: &Input) -> Value {
    let envelope = &input.extraction.envelope;
    match (route.fit)(envelope, &Seed::new(0).child(route.id)) {
        Ok(fit) => json!({
            "id": route.id, "title": route.title, "decay_rate": fit.decay_rate, "zeta": envelope.damping_ratio(fit.decay_rate),
        }),
        Err(error) => json!({ "id": route.id, "title": route.title, "error": error.to_string() }),
    }
}

fn identified(entry: &Entry, input: &Input) -> Value {
    let envelope = &input.extraction.envelope;
    let cancel = Cancel::default();
    let fit = || {
        let section = [Section { name: "estimator", fields: entry.fields }];
        let defaults = Resolved::new(&Document::default(), &section).map_err(|error| error.to_string())?;
        let estimator = (entry.build)(&defaults).map_err(|error| error.to_string())?;
        let context = FitContext::new(Seed::new(0).child(entry.id), None, &Silent, &cancel);
        estimator.fit(envelope, &context).map_err(|error| error.to_string())
    };
    match fit() {
        Ok(fit) => json!({
            "id": entry.id, "title": entry.title, "decay_rate": fit.decay_rate,
            "zeta": envelope.damping_ratio(fit.decay_rate), "equation": fit.equation,
        }),
        Err(error) => json!({ "id": entry.id, "title": entry.title, "error": error }),
    }
}
