//! Examples ready to click: the shipped record, and records simulated in the page with an effect of a chosen size.

use crate::host::Answered;
use dynamics::{Coordinate, Effect, Units};
use serde::Deserialize;
use serde_json::{Value, json};
use settings::Document;
use simulator::{GenerationError, Plan, csv_text, generate, nominal_text};

/// The shipped record, simulated too, with its nominal simulator.
const SHIPPED: [&str; 2] = [
    include_str!("../../../experiments/default-record/record.csv"),
    include_str!("../../../experiments/default-record/nominal.toml"),
];

/// Effects, one or more of each class, with usual parameters for [`SWING`]; the slider scales the first parameter.
const EXAMPLES: &[(&str, &[f64])] = &[
    ("coulomb_friction", &[1.0]),
    ("stribeck_friction", &[0.5, 2.0, 1.0]),
    ("hysteresis", &[2.0, 0.05]),
    ("quadratic_drag", &[0.2]),
    ("cubic_stiffness", &[-60.0]),
    ("gravity", &[150.0, 0.4]),
    ("backlash", &[0.01]),
    ("end_stop", &[0.45, 20_000.0, 0.05]),
    ("flexible_coupling", &[0.05, 40.0, 0.2]),
    ("stiffness_drift", &[0.004]),
    ("periodic_forcing", &[4.0, 26.0, 0.3]),
    ("sensor_lag", &[0.01]),
    ("sensor_quantization", &[0.02]),
    ("clock_drift", &[0.002, 0.0002]),
    ("timestamp_batching", &[0.06, 0.003]),
];

/// Configuration of a swing of 3.5 Hz per unit of inertia with a damping ratio of 0.006, as `trainer simulate` takes it.
const SWING: &str = "task = \"simulate\"\n\
    simulate.systems = 1\nsimulate.records = 1\n\
    record.rate_hz = 200.0\nrecord.seconds = 20.0\nstart.position = 0.6\nsensor.noise = 3e-4\n\
    nominal.inertia = 1.0\nnominal.damping = 0.264\nnominal.stiffness = 483.6\n";

/// Request for the record of an example.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ExampleRequest {
    /// Id of the effect; `shipped` for the shipped record, and `none` for a swing without an effect.
    effect: String,
    /// Size of the effect, 1 for its usual one.
    size: f64,
}

/// Lists the examples with their titles and what the slider scales.
pub(crate) fn examples() -> Vec<Value> {
    let described = |(id, values): &(&str, &[f64])| {
        let description = Effect::find(id).ok()?.description();
        let first = description.parameters.first()?;
        Some(json!({
            "id": id,
            "title": description.title,
            "parameter": first.name.replace('_', " "),
            "usual": values.first(),
            "unit": first.quantity.unit(Units::PerInertia(Coordinate::Angle)),
        }))
    };
    EXAMPLES.iter().filter_map(described).collect()
}

/// Simulates the record of an example: its text, that of its nominal simulator, and the configuration of both.
pub(crate) fn simulated(request: &ExampleRequest) -> Answered {
    if request.effect == "shipped" {
        let [record, nominal] = SHIPPED;
        return Ok(json!({ "record": record, "nominal": nominal, "configuration": null }));
    }
    let configuration = configuration(request)?;
    let document = Document::parse("simulate.toml", &configuration).map_err(|error| error.to_string())?;
    let plan = Plan::resolve(&document).map_err(|error| error.to_string())?;
    let made = || {
        let drawn = plan.draw(0)?;
        let truth = drawn.truths.first().ok_or(GenerationError::NoSuchRecord { record: 0 })?;
        let record = generate(truth)?;
        let text = csv_text(&record, truth.sampling.stamp_decimals, truth.sampling.value_decimals);
        Ok((text, nominal_text(&drawn.nominal)))
    };
    let (record, nominal) = made().map_err(|error: GenerationError| error.to_string())?;
    Ok(json!({ "record": record, "nominal": nominal, "configuration": configuration }))
}

/// Returns the configuration of an example.
fn configuration(request: &ExampleRequest) -> Result<String, String> {
    let mut text = SWING.to_owned();
    let Some((id, values)) = EXAMPLES.iter().find(|(id, _)| *id == request.effect) else {
        return if request.effect == "none" {
            Ok(text)
        } else {
            Err(format!("no example {}", request.effect))
        };
    };
    let effect = Effect::find(id).map_err(|error| error.to_string())?;
    text.push_str(&format!("\n[[effects]]\nid = \"{id}\"\n"));
    for (at, (parameter, value)) in effect.description().parameters.iter().zip(*values).enumerate() {
        let value = if at == 0 { value * request.size } else { *value };
        text.push_str(&format!("parameters.{} = {value:?}\n", parameter.name));
    }
    Ok(text)
}
