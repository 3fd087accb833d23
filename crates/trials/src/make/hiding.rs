//! What the banks hide: which effects, which pairs.

use std::sync::LazyLock;

/// Hidden alone only.
const ALONE: u8 = 0;

/// A measured input shows it, and nothing else does.
const NEEDS_INPUT: u8 = 1;

/// Nothing else in the vocabulary is nearly the same thing: with it left out `unknown` is the right answer. Without this
/// are gravity and cubic stiffness, which replace one another, the dry frictions and hysteresis, stiffness drift and clock
/// drift, a preload and a calibrated rest angle, and what scatters values or stamps and is noise to whoever knows no better.
const LEFT_OUT: u8 = 2;

/// A second release tells something about it.
const RELEASED: u8 = 4;

/// It is laid under residuals of measured records, whose stamps are their own.
const MEASURED: u8 = 8;

/// It acts in driven records, wherever its place of action is no release.
const DRIVEN: u8 = 16;

/// Every effect of the vocabulary, and the banks beside those of one effect alone that hide it.
const HIDDEN: &[(&str, u8)] = &[
    ("coulomb_friction", RELEASED | MEASURED | DRIVEN),
    ("stribeck_friction", RELEASED | MEASURED | DRIVEN),
    ("quadratic_drag", LEFT_OUT | RELEASED | MEASURED | DRIVEN),
    ("cubic_stiffness", RELEASED | MEASURED | DRIVEN),
    ("asymmetric_stiffness", RELEASED | MEASURED | DRIVEN),
    ("gravity", RELEASED | MEASURED | DRIVEN),
    ("constant_torque", ALONE),
    ("backlash", LEFT_OUT | RELEASED | MEASURED | DRIVEN),
    ("hysteresis", RELEASED | MEASURED | DRIVEN),
    ("end_stop", LEFT_OUT | RELEASED | MEASURED | DRIVEN),
    ("stiffness_drift", RELEASED | MEASURED | DRIVEN),
    ("damping_drift", LEFT_OUT | RELEASED | MEASURED | DRIVEN),
    ("periodic_forcing", LEFT_OUT | DRIVEN),
    ("flexible_coupling", LEFT_OUT | RELEASED | MEASURED | DRIVEN),
    ("input_delay", NEEDS_INPUT),
    ("input_saturation", NEEDS_INPUT | LEFT_OUT),
    ("sensor_lag", NEEDS_INPUT),
    ("sensor_nonlinearity", LEFT_OUT | RELEASED | MEASURED | DRIVEN),
    ("sensor_drift", LEFT_OUT | DRIVEN),
    ("sensor_saturation", LEFT_OUT),
    ("sensor_quantization", ALONE),
    ("outliers", ALONE),
    ("dropouts", ALONE),
    ("clock_drift", RELEASED),
    ("timestamp_jitter", ALONE),
    ("timestamp_batching", ALONE),
];

/// Effects that a bank hides, in the order of the vocabulary.
type Effects = LazyLock<Vec<&'static str>>;

fn with(bank: u8) -> impl Iterator<Item = &'static str> {
    HIDDEN.iter().filter(move |(_, banks)| banks & bank != 0).map(|(id, _)| *id)
}

/// Every effect of the vocabulary.
pub(crate) static SINGLE: Effects = LazyLock::new(|| HIDDEN.iter().map(|(id, _)| *id).collect());

/// Effects that are left out of what the diagnosis considers.
pub(crate) static UNNAMED: Effects = LazyLock::new(|| with(LEFT_OUT).collect());

/// Effects hidden in records with several releases.
pub(crate) static RELEASES: Effects = LazyLock::new(|| with(RELEASED).collect());

/// Effects laid under residuals of measured records.
pub(crate) static RESIDUALS: Effects = LazyLock::new(|| with(MEASURED).collect());

/// Effects hidden in driven records, those of the input first.
pub(crate) static INPUTS: Effects = LazyLock::new(|| with(NEEDS_INPUT).chain(with(DRIVEN)).collect());

/// Whether only a measured input shows an effect.
pub(crate) fn needs_input(id: &str) -> bool {
    with(NEEDS_INPUT).any(|other| other == id)
}

/// Two effects that occur together, and where.
pub(crate) const PAIRS: &[(&str, &str, &str)] = &[
    ("coulomb_friction", "quadratic_drag", "a dry bearing and a paddle in air"),
    ("coulomb_friction", "gravity", "a spring-loaded arm that also hangs, on a dry bearing"),
    ("coulomb_friction", "sensor_nonlinearity", "a dry bearing read by an eccentric encoder magnet"),
    ("coulomb_friction", "backlash", "a worn gear with seals"),
    ("coulomb_friction", "periodic_forcing", "a dry bearing beside a running fan"),
    ("stribeck_friction", "gravity", "a greased joint of a robot arm"),
    ("quadratic_drag", "cubic_stiffness", "a paddle on a leaf spring"),
    ("quadratic_drag", "gravity", "a pendulum with a sail"),
    ("quadratic_drag", "stiffness_drift", "a paddle on a spring that warms up"),
    ("quadratic_drag", "clock_drift", "a paddle logged by a host whose clock is being disciplined"),
    ("hysteresis", "cubic_stiffness", "a rubber bushing"),
    ("hysteresis", "constant_torque", "a preloaded cable drive"),
    ("asymmetric_stiffness", "damping_drift", "a preloaded spring in oil that warms up"),
    ("flexible_coupling", "coulomb_friction", "a load on a shaft with a seal"),
    ("end_stop", "quadratic_drag", "a valve flap that touches its seat"),
    ("backlash", "sensor_drift", "a worn gear read by a potentiometer that warms up"),
    ("cubic_stiffness", "sensor_saturation", "a leaf spring swung beyond the sensor's range"),
    ("periodic_forcing", "sensor_drift", "a strain gauge beside a machine"),
];

#[cfg(test)]
mod tests {
    use super::{PAIRS, SINGLE};
    use dynamics::{Effect, REGISTRY};

    #[test]
    fn every_effect_of_the_vocabulary_is_hidden_alone() {
        assert_eq!(*SINGLE, REGISTRY.iter().map(|effect| effect.id()).collect::<Vec<_>>());
    }

    #[test]
    fn pairs_are_of_two_effects_and_listed_once() {
        for (number, (one, other, _)) in PAIRS.iter().enumerate() {
            Effect::find(one).unwrap();
            Effect::find(other).unwrap();
            assert!(one != other && !PAIRS[..number].iter().any(|pair| (pair.0, pair.1) == (*one, *other)));
        }
    }
}
