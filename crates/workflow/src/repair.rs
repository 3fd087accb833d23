//! The repaired simulator: the recalibrated nominal one with the effects that were fitted.

use crate::read::{Given, observed};
use crate::result::title;
use diagnosis::{Diagnosis, has_fitted_hidden_start, rounded};
use dynamics::{Active, DynamicsError, Effect, Start, System, Units};
use export::Repaired;

/// Relative errors of a noise from some thousand samples, and of a clock's rate and span at best.
const OF_NOISE: f64 = 0.01;
const OF_TIME: f64 = 1e-6;

/// Puts it together. An effect without coefficients of its own (stamps in bursts, say) cannot be part of it and is
/// listed; so are numbers that the data do not determine.
pub(crate) fn repaired(found: &Diagnosis, given: &[Given], units: Units) -> Result<Repaired, DynamicsError> {
    let own = &found.repaired;
    let (effects, chain): (Vec<Active>, Vec<Active>) =
        own.effects.iter().partition(|active| matches!(active.effect(), Effect::System(_)));
    let mut left_out: Vec<String> = Vec::new();
    for active in effects.iter().filter(|active| has_fitted_hidden_start(active.id())) {
        let title = title(active.id());
        left_out
            .push(format!("{title}: the second body's own motion at the start; here it starts moving along"));
    }
    left_out.extend(own.left_out.iter().map(|(id, reason)| format!("{}: {reason}", title(id))));
    for id in &found.verdict.effects {
        if !own.effects.iter().any(|active| active.id() == *id) {
            left_out.push(match Effect::find(id).map(|effect| effect.description().kind) {
                Ok(dynamics::Kind::System) => format!("{}: the rest angle has it already", title(id)),
                _ => format!("{}: seen in stamps or values directly, no coefficient was fitted", title(id)),
            });
        }
    }
    left_out.extend(own.undetermined.iter().map(|number| {
        let here = if number.is_nominal { "the nominal simulator's" } else { "the best fit's" };
        format!("a number for {} that these data determine; the one here is {here}", number.name)
    }));
    let system = match System::new(own.nominal, effects) {
        Ok(system) => system,
        Err(error) => {
            left_out.push(format!("every effect in the system: {error}"));
            System::new(own.nominal, Vec::new())?
        }
    };
    // Rounding is a part of the floor, and the repaired chain may do it by itself.
    let rounding = chain.iter().filter_map(|own: &Active| own.value("step")).map(|step| step * step / 12.0);
    let noise = (found.gap.noise_floor.value.powi(2) - rounding.sum::<f64>()).max(0.0).sqrt();
    let first = given.first();
    let (rate_hz, seconds) = first.map_or((1.0, 1.0), |given| (given.rate_hz, given.row.duration_s));
    // What the sensor's noise leaves of a position, and of a velocity over a swing or the record.
    let per_second = system.nominal().angular_frequency().max(1.0 / seconds);
    // A diagnosis of no sample was refused before.
    let at_start = |values: &[f64], error| rounded(values.first().copied().unwrap_or_default(), error);
    Ok(Repaired {
        system,
        units,
        chain,
        left_out,
        input: own.input_hold,
        start: Start {
            position: at_start(&found.series.position, noise),
            velocity: at_start(&found.series.velocity, noise * per_second),
        },
        // Without a record nothing says what is observed: an angle, as everywhere.
        observed: observed(first.map(|given| given.quantity).unwrap_or_default()),
        noise: rounded(noise, OF_NOISE * noise),
        rate_hz: rounded(rate_hz, OF_TIME * rate_hz),
        seconds: rounded(seconds, OF_TIME * seconds),
    })
}
