//! Effects of the vocabulary as trials hide and score them, one file each.
//!
//! The rest of the crate works with a [`TrialEffect`] and names no effect. Nothing here is shared with the
//! diagnosis: neither the draws of a case nor the classes of its score may depend on what a fit tries or how
//! an answer groups effects.
//!
//! # Adding an effect
//! Add `effects/NAME.rs` with a constant `EFFECT`: [`TrialEffect::new`] with the effect, its class, and the
//! rule for its size, usually a [`Shape`](size::Shape) drawn for a system. `gravity.rs` uses all parts,
//! `input_delay.rs` the fewest. Add the module and the line in [`REGISTRY`] below at the effect's position in
//! `dynamics`.

mod asymmetric_stiffness;
mod backlash;
mod bristles;
mod clock_drift;
mod command_derivative;
mod constant_torque;
mod coulomb_friction;
mod cubic_stiffness;
mod damping_drift;
mod directional_friction;
mod drive_dead_band;
mod dropouts;
mod effect_class;
mod end_stop;
mod flexible_coupling;
mod friction_drift;
mod gravity;
mod hysteresis;
mod input_delay;
mod input_saturation;
mod load_friction;
mod other_law;
mod outliers;
mod periodic_forcing;
mod quadratic_drag;
mod sensor_drift;
mod sensor_lag;
mod sensor_nonlinearity;
mod sensor_quantization;
mod sensor_saturation;
mod settling_drift;
mod size;
mod speed_torque_limit;
mod stiffness_drift;
mod stribeck_friction;
mod timestamp_batching;
mod timestamp_jitter;
mod torque_limit;
mod trial_effect;

use crate::hidden::Bank;
pub(crate) use effect_class::EffectClass;
pub(crate) use other_law::{DrawnLaw, OtherLaw};
pub(crate) use size::{Size, Wanted};
pub(crate) use trial_effect::{SEPARABLE_OTHERWISE, TrialEffect};

/// All effects, in the order of the vocabulary.
pub(crate) static REGISTRY: &[TrialEffect] = &[
    coulomb_friction::EFFECT,
    stribeck_friction::EFFECT,
    quadratic_drag::EFFECT,
    cubic_stiffness::EFFECT,
    asymmetric_stiffness::EFFECT,
    gravity::EFFECT,
    constant_torque::EFFECT,
    backlash::EFFECT,
    hysteresis::EFFECT,
    end_stop::EFFECT,
    stiffness_drift::EFFECT,
    damping_drift::EFFECT,
    periodic_forcing::EFFECT,
    flexible_coupling::EFFECT,
    input_delay::EFFECT,
    input_saturation::EFFECT,
    command_derivative::EFFECT,
    torque_limit::EFFECT,
    load_friction::EFFECT,
    directional_friction::EFFECT,
    friction_drift::EFFECT,
    drive_dead_band::EFFECT,
    speed_torque_limit::EFFECT,
    sensor_lag::EFFECT,
    sensor_nonlinearity::EFFECT,
    sensor_drift::EFFECT,
    sensor_saturation::EFFECT,
    sensor_quantization::EFFECT,
    outliers::EFFECT,
    dropouts::EFFECT,
    clock_drift::EFFECT,
    timestamp_jitter::EFFECT,
    timestamp_batching::EFFECT,
];

/// Returns the effect with an identifier.
pub(crate) fn find(id: &str) -> Option<&'static TrialEffect> {
    REGISTRY.iter().find(|effect| effect.id() == id)
}

/// Returns the effects that a bank hides in turn, in the order of the vocabulary. For driven records, effects
/// that need an input come first.
pub(crate) fn hidden_in(bank: Bank) -> Vec<&'static TrialEffect> {
    let mut effects: Vec<_> = REGISTRY.iter().filter(|effect| effect.is_hidden_in(bank)).collect();
    if bank == Bank::Driven {
        effects.sort_by_key(|effect| !effect.needs_input);
    }
    effects
}

/// Returns the effects that have a law besides the vocabulary's; those of the stressed bank come first.
pub(crate) fn by_other_laws() -> Vec<(&'static TrialEffect, OtherLaw)> {
    let own = REGISTRY.iter().filter_map(|effect| Some((effect, effect.other_law?)));
    let mut effects: Vec<_> = own.collect();
    effects.sort_by_key(|(effect, _)| !effect.is_hidden_in(Bank::Stressed));
    effects
}

/// Returns the class of an effect; for an identifier that is no effect, the identifier itself.
pub(crate) fn class_of(id: &str) -> &str {
    find(id).map_or(id, |effect| effect.class.id())
}

#[cfg(test)]
mod tests {
    use super::*;
    use dynamics::REGISTRY as VOCABULARY;

    #[test]
    fn every_effect_of_the_vocabulary_is_hidden_alone_and_has_a_class() {
        let ids: Vec<&str> = hidden_in(Bank::Single).iter().map(|effect| effect.id()).collect();
        assert_eq!(ids, VOCABULARY.iter().map(|effect| effect.id()).collect::<Vec<_>>());
        assert!(VOCABULARY.iter().all(|effect| class_of(effect.id()) != effect.id()));
        assert_eq!(class_of("unknown"), "unknown");
        assert!(EffectClass::ALL.iter().all(|class| REGISTRY.iter().any(|effect| effect.class == *class)));
    }

    #[test]
    fn banks_hide_what_can_be_seen_there() {
        let driven = hidden_in(Bank::Driven);
        assert_eq!(driven.iter().position(|effect| !effect.needs_input), Some(10));
        assert!(
            REGISTRY
                .iter()
                .all(|effect| !effect.needs_input || driven.iter().any(|other| other.id() == effect.id()))
        );
        for effect in hidden_in(Bank::Stressed) {
            assert!(effect.other_law.is_some(), "{}", effect.id());
        }
        let (stressed, all) = (hidden_in(Bank::Stressed), by_other_laws());
        assert!(stressed.iter().zip(&all).all(|(one, (other, _))| one.id() == other.id()));
    }

    #[test]
    fn what_is_alike_is_so_both_ways() {
        for effect in REGISTRY {
            for other in effect.alike {
                assert!(find(other.id()).unwrap().alike.contains(&effect.effect), "{}", effect.id());
            }
            assert!(effect.separable.iter().all(|size| *size > 0.0));
        }
    }
}
