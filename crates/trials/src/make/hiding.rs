//! What the banks hide: which effects, which pairs.

/// Every effect of the vocabulary that acts in a free decay, and the three that take a measured input.
pub(crate) const SINGLE: &[&str] = &[
    "coulomb_friction",
    "stribeck_friction",
    "quadratic_drag",
    "cubic_stiffness",
    "asymmetric_stiffness",
    "gravity",
    "constant_torque",
    "backlash",
    "hysteresis",
    "end_stop",
    "stiffness_drift",
    "damping_drift",
    "periodic_forcing",
    "flexible_coupling",
    "input_delay",
    "input_saturation",
    "sensor_lag",
    "sensor_nonlinearity",
    "sensor_drift",
    "sensor_saturation",
    "sensor_quantization",
    "outliers",
    "dropouts",
    "clock_drift",
    "timestamp_jitter",
    "timestamp_batching",
];

/// Effects that only a measured input shows.
pub(crate) const NEEDS_INPUT: &[&str] = &["input_delay", "input_saturation", "sensor_lag"];

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

/// Effects for which nothing else in the vocabulary is nearly the same thing: with one of these left out
/// `unknown` is the right answer. Left out of this list are those with a stand-in: gravity and cubic
/// stiffness for one another, the dry frictions and hysteresis, stiffness drift and clock drift, a preload
/// and a calibrated rest angle, and what scatters values or stamps and is noise to whoever knows no better.
pub(crate) const LEFT_OUT: &[&str] = &[
    "quadratic_drag",
    "backlash",
    "end_stop",
    "damping_drift",
    "periodic_forcing",
    "flexible_coupling",
    "input_saturation",
    "sensor_nonlinearity",
    "sensor_drift",
    "sensor_saturation",
];

/// Effects that a second release tells something about.
pub(crate) const RELEASES: &[&str] = &[
    "coulomb_friction",
    "stribeck_friction",
    "quadratic_drag",
    "cubic_stiffness",
    "asymmetric_stiffness",
    "gravity",
    "backlash",
    "hysteresis",
    "end_stop",
    "stiffness_drift",
    "damping_drift",
    "flexible_coupling",
    "sensor_nonlinearity",
    "clock_drift",
];

/// Effects laid under residuals of measured records: those of a release, but for a drifting clock, as the
/// stamps are the measured record's own.
pub(crate) const MEASURED: &[&str] = &[
    "coulomb_friction",
    "stribeck_friction",
    "quadratic_drag",
    "cubic_stiffness",
    "asymmetric_stiffness",
    "gravity",
    "backlash",
    "hysteresis",
    "end_stop",
    "stiffness_drift",
    "damping_drift",
    "flexible_coupling",
    "sensor_nonlinearity",
];

/// Effects hidden in driven records: all that act in one record of any kind, but for those whose place of
/// action is a release.
pub(crate) const DRIVEN: &[&str] = &[
    "input_delay",
    "input_saturation",
    "sensor_lag",
    "coulomb_friction",
    "stribeck_friction",
    "quadratic_drag",
    "cubic_stiffness",
    "asymmetric_stiffness",
    "gravity",
    "backlash",
    "hysteresis",
    "end_stop",
    "stiffness_drift",
    "damping_drift",
    "periodic_forcing",
    "flexible_coupling",
    "sensor_nonlinearity",
    "sensor_drift",
];

#[cfg(test)]
mod tests {
    use super::{DRIVEN, LEFT_OUT, MEASURED, NEEDS_INPUT, PAIRS, RELEASES, SINGLE};
    use dynamics::{Effect, REGISTRY};

    #[test]
    fn every_effect_of_the_vocabulary_is_hidden_alone() {
        assert_eq!(SINGLE, REGISTRY.iter().map(|effect| effect.id()).collect::<Vec<_>>());
    }

    #[test]
    fn lists_name_effects_once() {
        for list in [LEFT_OUT, RELEASES, MEASURED, DRIVEN, NEEDS_INPUT] {
            for (number, id) in list.iter().enumerate() {
                Effect::find(id).unwrap();
                assert!(!list[..number].contains(id), "{id}");
            }
        }
        for (number, (one, other, _)) in PAIRS.iter().enumerate() {
            Effect::find(one).unwrap();
            Effect::find(other).unwrap();
            assert!(one != other && !PAIRS[..number].iter().any(|pair| (pair.0, pair.1) == (*one, *other)));
        }
    }
}
