//! Estimates of the decay of the dropped logs by least squares and the other methods that need no network.

use crate::host::Answered;
use crate::reading::{experiment, reading};
use oracle::classical::{CLASSICAL, ClassicalRoute};
use results::{PipelineOutcome, PipelineRow};
use seed::Seed;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use workflow::estimate::Input;
use workflow::read::Loaded;
use workflow::{Log, in_options};

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
            "methods": CLASSICAL.iter().map(|route| method(route, &input)).collect::<Vec<_>>(),
            "because": input.extraction.because,
        }))
    };
    let told = |log: &Log| of(log).unwrap_or_else(|error| json!({ "name": log.name, "error": error }));
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
