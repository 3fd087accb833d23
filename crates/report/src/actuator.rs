//! Inner loop of a joint in words: what is told of it whatever its gain.

use crate::format::{estimate, quantity, significant, unit};
use results::{ActuatorRow, DiagnosisResult, RatioRow};

/// Probability from which on an effect's ratios are listed.
const LIKELY: f64 = 0.5;

/// Returns the sentence on a joint's inner loop: how its gain is known, and what is told whatever it is. Empty without
/// a loop.
#[must_use]
pub fn actuator_sentence(result: &DiagnosisResult) -> String {
    let Some(ActuatorRow { kind, gain, ratios }) = &result.actuator else { return String::new() };
    if kind == "torque" {
        return String::new();
    }
    let value = quantity(&significant(gain.value, 4), &gain.unit);
    let known = match (gain.stated.as_str(), gain.tolerance) {
        ("known", _) => format!("The loop's gain is stated as known, {value}."),
        (_, Some(tolerance)) => format!(
            "The loop's gain is stated as {value}, to ± {}: every torque is uncertain by as much, and only its ratio \
             to the gain is told by the records.",
            significant(tolerance, 2)
        ),
        _ => format!(
            "The loop's gain is unknown. Every torque is stated beside an assumed {value}, and only its ratio to the \
             gain is told by the records; a record under a known load would tell the gain."
        ),
    };
    let is_named = |name: &str| {
        let id = name.split_once('.').map(|(id, _)| id);
        id.is_none_or(|id| {
            result.effects.iter().any(|effect| effect.id == id && effect.probability >= LIKELY)
        })
    };
    let told = |(name, RatioRow { estimate: own, unit: symbol }): (&String, &RatioRow)| {
        let text = format!("{name} {}", estimate(own.value, own.interval_95, unit(symbol)));
        is_named(name).then_some(text)
    };
    let told: Vec<String> = ratios.iter().filter_map(told).collect();
    if told.is_empty() { known } else { format!("{known} Over the gain: {}.", told.join(", ")) }
}
