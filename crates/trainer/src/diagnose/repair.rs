//! The repaired simulator: the recalibrated nominal one with the effects that were fitted.

use super::read::{Given, observed};
use super::result::title;
use diagnosis::{Diagnosis, EffectProbability, has_fitted_hidden_start};
use dynamics::{Active, DynamicsError, Effect, Start, System, Units};
use export::Repaired;

/// Puts it together. An effect without coefficients of its own (stamps in bursts, say) cannot be part of it and is
/// listed.
pub(crate) fn repaired(found: &Diagnosis, given: &[Given], units: Units) -> Result<Repaired, DynamicsError> {
    let (mut effects, mut chain, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
    // The effects that the repaired fit has are those that carry a share of the gap.
    for row in found.effects.iter().filter(|row| row.gap_share.is_some()) {
        match active(row) {
            Ok(active) => {
                match active.effect() {
                    Effect::System(_) => {
                        if has_fitted_hidden_start(row.id) {
                            let title = title(row.id);
                            left_out.push(format!("{title}: the second body's own motion at the start; here it starts moving along"));
                        }
                        effects.push(active);
                    }
                    Effect::MeasuringChain(_) => chain.push(active),
                }
            }
            Err(error) => left_out.push(format!("{}: {error}", title(row.id))),
        }
    }
    for id in &found.verdict.effects {
        if !found.effects.iter().any(|row| row.id == *id && row.gap_share.is_some()) {
            left_out.push(match Effect::find(id).map(|effect| effect.description().kind) {
                Ok(dynamics::Kind::System) => format!("{}: the rest angle has it already", title(id)),
                _ => format!("{}: seen in stamps or values directly, no coefficient was fitted", title(id)),
            });
        }
    }
    let system = match System::new(found.repaired_nominal, effects) {
        Ok(system) => system,
        Err(error) => {
            left_out.push(format!("every effect in the system: {error}"));
            System::new(found.repaired_nominal, Vec::new())?
        }
    };
    // Rounding is a part of the floor, and the repaired chain may do it by itself.
    let rounding = chain.iter().filter_map(|own: &Active| own.value("step")).map(|step| step * step / 12.0);
    let noise = (found.gap.noise_floor.value.powi(2) - rounding.sum::<f64>()).max(0.0).sqrt();
    let first = given.first();
    let at_start = |values: &[f64]| values.first().copied().unwrap_or_default();
    Ok(Repaired {
        system,
        units,
        chain,
        left_out,
        driven: first.is_some_and(|given| given.driven),
        start: Start {
            position: at_start(&found.series.position),
            velocity: at_start(&found.series.velocity),
        },
        observed: observed(first.map(|given| given.quantity).unwrap_or_default()),
        noise,
        rate_hz: first.map_or(1.0, |given| given.rate_hz),
        seconds: first.map_or(1.0, |given| given.row.duration_s),
    })
}

/// An effect with its fitted parameters; one that the fit left alone is 0.
fn active(row: &EffectProbability) -> Result<Active, DynamicsError> {
    let effect = Effect::find(row.id)?;
    let values: Vec<f64> = effect
        .description()
        .parameters
        .iter()
        .map(|parameter| {
            let own = row.parameters.iter().find(|own| own.name == parameter.name);
            own.map_or(0.0, |own| own.estimate.value)
        })
        .collect();
    Active::of(effect, &values)
}
