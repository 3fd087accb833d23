//! Regret: how far an answer's error lies above that of the set that is there.
//!
//! It tells what was not found from what was not decided. An answer with a regret near 1 leaves no more than the true
//! effects do; one far above 1 never tried the set that is there, or lost its fit.

use super::judgment::Judgment;
use super::statistics::proportion;
use crate::hidden::Hidden;
use dynamics::{Active, Effect, KnownEffect, NominalSimulator};
use results::Proportion;

/// Regret above which a better set was missed.
const MISSED: f64 = 1.1;

/// Returns the nominal simulator with the hidden effects added at their true parameters, and with the true
/// coefficients if the truth states them. Recalibrated, it is the best fit of what is there by the vocabulary's laws.
///
/// # Errors
/// A text with the reason why there is no such simulator: no effect is hidden, a law outside the vocabulary asks for
/// `unknown`, or an effect that no simulator can hold acts alone.
pub fn with_the_truth(hidden: &Hidden, nominal: &NominalSimulator) -> Result<NominalSimulator, String> {
    if hidden.foreign.is_some() || hidden.without.is_some() {
        return Err("what is missing has no name".to_owned());
    }
    // Random errors of stamps and values, such as jitter and outliers, are part of no simulator.
    let is_held = |id: &str| match Effect::find(id) {
        Ok(Effect::System(_)) => true,
        Ok(Effect::MeasuringChain(effect)) => effect.is_differentiable(),
        Err(_) => false,
    };
    let added = hidden.effects.iter().filter(|effect| is_held(&effect.id)).map(|effect| {
        Active::new(&effect.id, &effect.parameters).map(|active| KnownEffect { active, recalibrate: true })
    });
    let added: Vec<KnownEffect> = added.collect::<Result<_, _>>().map_err(|error| error.to_string())?;
    if added.is_empty() {
        return Err("no hidden effect can be part of a simulator".to_owned());
    }
    let truth = hidden.records.first().map_or(nominal.nominal(), |truth| truth.system.nominal());
    nominal
        .nominal()
        .with_coefficients(truth.coefficients())
        .and_then(|oscillator| NominalSimulator::new(oscillator, [nominal.effects(), &added].concat()))
        .map_err(|error| error.to_string())
}

/// Returns the share of cases with a regret above [`MISSED`], among those with a reference.
pub(super) fn missed<'j, 'c: 'j>(judged: impl Iterator<Item = &'j Judgment<'c>>) -> Proportion {
    proportion(judged.filter_map(Judgment::regret).map(|regret| regret > MISSED))
}

#[cfg(test)]
mod tests {
    use super::with_the_truth;
    use crate::hidden::{Bank, HiddenEffect};
    use crate::score::sample::{answered, case};
    use dynamics::Nominal;

    /// Gives effects parameters with which they act.
    fn with_parameters(effects: &mut [HiddenEffect]) {
        for effect in effects {
            effect.parameters = if effect.id == "outliers" { vec![0.01, 0.35] } else { vec![3.0] };
        }
    }

    #[test]
    fn the_reference_has_the_hidden_effects_with_their_parameters() {
        let nominal = (&Nominal::new(1.0, 0.1, 40.0, 0.0).unwrap()).into();
        let mut own = case(Bank::Composite, &["cubic_stiffness", "outliers"], answered("effect", &[], 0.9));
        with_parameters(&mut own.hidden.effects);
        let simulator = with_the_truth(&own.hidden, &nominal).unwrap();
        let [effect] = simulator.effects() else { panic!("{simulator:?}") };
        assert!(effect.recalibrate && effect.active.id() == "cubic_stiffness");
        assert_eq!(effect.active.values(), [3.0]);
    }

    #[test]
    fn without_an_effect_of_a_simulator_there_is_no_reference() {
        let nominal = (&Nominal::new(1.0, 0.1, 40.0, 0.0).unwrap()).into();
        let not_held = "no hidden effect can be part of a simulator";
        for (mut own, expected) in [
            (case(Bank::None, &[], answered("none", &[], 0.9)), not_held),
            (case(Bank::Foreign, &[], answered("unknown", &[], 0.9)), "what is missing has no name"),
            (case(Bank::Single, &["outliers"], answered("effect", &[], 0.9)), not_held),
        ] {
            with_parameters(&mut own.hidden.effects);
            assert_eq!(with_the_truth(&own.hidden, &nominal).unwrap_err(), expected);
        }
    }
}
