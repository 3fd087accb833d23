//! Pairs of effects that occur together.

use super::error::TrialError;
use crate::effects::{TrialEffect, find};

/// Two effects that occur together, and an example of a system that has both.
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

/// Returns the effects of a pair.
///
/// # Errors
/// [`TrialError::NoEffect`] if one of them is no longer in the vocabulary.
pub(crate) fn effects_of(
    (one, other, _): &(&str, &str, &str),
) -> Result<[&'static TrialEffect; 2], TrialError> {
    let known = |id: &str| find(id).ok_or_else(|| TrialError::NoEffect { id: id.to_owned() });
    Ok([known(one)?, known(other)?])
}

#[cfg(test)]
mod tests {
    use super::{PAIRS, effects_of};

    #[test]
    fn pairs_are_of_two_effects_and_listed_once() {
        for (number, pair) in PAIRS.iter().enumerate() {
            let [one, other] = effects_of(pair).unwrap();
            assert!(one.id() != other.id());
            assert!(!PAIRS[..number].iter().any(|before| (before.0, before.1) == (pair.0, pair.1)));
        }
    }
}
