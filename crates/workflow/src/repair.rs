//! Repaired simulator: the recalibrated simulator with the fitted effects.

#![allow(
    clippy::indexing_slicing,
    reason = "a diagnosis has a state for every sample, and refuses records without"
)]

use crate::read::{Given, observed};
use crate::result::title;
use diagnosis::{Diagnosis, StartState, rounded};
use dynamics::{Active, DynamicsError, Effect, Start, System, Units};
use export::Repaired;

/// Relative errors of a noise level from some thousand samples, and, at best, of a clock's rate and span.
const OF_NOISE: f64 = 0.01;
const OF_TIME: f64 = 1e-6;

/// Returns what the repaired simulator of a diagnosis cannot include, in sentences.
fn left_out(found: &Diagnosis) -> Vec<String> {
    let own = &found.repaired;
    let mut left_out: Vec<String> = Vec::new();
    left_out.extend(own.left_out.iter().map(|(id, reason)| format!("{}: {reason}", title(id))));
    for id in &found.verdict.effects {
        if !own.effects.iter().any(|active| active.id() == *id) {
            left_out.push(match Effect::find(id).map(|effect| effect.description().kind) {
                Ok(dynamics::Kind::System) => {
                    format!("{}: the fitted rest angle already includes it", title(id))
                }
                _ => {
                    format!("{}: found directly in stamps or values, so no coefficient was fitted", title(id))
                }
            });
        }
    }
    left_out.extend(own.undetermined.iter().map(|number| {
        let here = if number.is_nominal { "the nominal simulator's" } else { "the best fit's" };
        format!("a value of {} that these data determine; the value in this file is {here}", number.name)
    }));
    left_out
}

/// Builds the repaired simulator. An effect without coefficients of its own (stamps in bursts, say) cannot be
/// part of it and is listed instead; so are numbers that the data do not determine.
pub(crate) fn repaired(found: &Diagnosis, given: &[Given], units: Units) -> Result<Repaired, DynamicsError> {
    let own = &found.repaired;
    let (effects, chain): (Vec<Active>, Vec<Active>) =
        own.effects.iter().partition(|active| matches!(active.effect(), Effect::System(_)));
    let mut left_out = left_out(found);
    let system = match System::new(own.nominal, effects) {
        Ok(system) => system,
        Err(error) => {
            left_out.push(format!("every effect in the system: {error}"));
            System::new(own.nominal, Vec::new())?
        }
    };
    // Rounding is part of the noise floor; it is subtracted because the repaired chain may round by itself.
    let rounding = chain.iter().filter_map(|own: &Active| own.value("step")).map(|step| step * step / 12.0);
    let noise = (found.gap.noise_floor.powi(2) - rounding.sum::<f64>()).max(0.0).sqrt();
    let first = given.first();
    let (rate_hz, seconds) = first.map_or((1.0, 1.0), |given| (given.rate_hz, given.row.duration_s));
    // Uncertainty that the sensor's noise leaves in a position, and in a velocity over a swing or the record.
    let per_second = system.nominal().angular_frequency().max(1.0 / seconds);
    let at_rate = noise * per_second;
    let start = own.start.clone().unwrap_or_else(|| StartState {
        position: found.series.position[0],
        velocity: found.series.velocity[0],
        hidden: Vec::new(),
    });
    // A hidden body's state is known less well than the first body's: its digits suffice.
    let hidden =
        |states: Vec<f64>| states.into_iter().map(|state| rounded(state, noise.min(at_rate))).collect();
    Ok(Repaired {
        system,
        units,
        chain,
        left_out,
        input: own.input_hold,
        start: Start { position: rounded(start.position, noise), velocity: rounded(start.velocity, at_rate) },
        hidden_starts: start.hidden.into_iter().map(|(id, states)| (id, hidden(states))).collect(),
        observed: observed(first.map_or(record::Quantity::Position, |given| given.quantity)),
        noise: rounded(noise, OF_NOISE * noise),
        rate_hz: rounded(rate_hz, OF_TIME * rate_hz),
        seconds: rounded(seconds, OF_TIME * seconds),
    })
}
