//! Fixtures shared by the tests of both integrators.

use crate::{Active, Hold, Input, Nominal, System};

/// Evenly spaced times from 0 to `duration` seconds, `rate` per second.
pub(crate) fn grid(duration: f64, rate: f64) -> Vec<f64> {
    (0..=(duration * rate).round() as usize).map(|i| i as f64 / rate).collect()
}

/// 3.5 Hz, damping ratio 0.006, per unit of inertia.
pub(crate) fn nominal() -> Nominal {
    let omega = 7.0 * std::f64::consts::PI;
    Nominal::new(1.0, 2.0 * 0.006 * omega, omega * omega, 0.02).unwrap()
}

pub(crate) fn with(nominal: Nominal, effects: &[(&str, &[f64])]) -> System {
    System::new(nominal, effects.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect())
        .unwrap()
}

/// One strength for each effect, large enough to matter over 25 s at 3.5 Hz from 0.7 rad.
pub(crate) const CASES: &[(&str, &[f64])] = &[
    ("coulomb_friction", &[1.0]),
    ("stribeck_friction", &[0.5, 1.0, 2.0]),
    ("quadratic_drag", &[0.05]),
    ("cubic_stiffness", &[120.0]),
    ("asymmetric_stiffness", &[60.0]),
    ("gravity", &[150.0, 0.4]),
    ("constant_torque", &[9.0]),
    ("backlash", &[0.01]),
    ("hysteresis", &[1.0, 0.01]),
    ("end_stop", &[-0.5, 20_000.0, 0.05]),
    ("stiffness_drift", &[0.002]),
    ("damping_drift", &[0.02]),
    ("periodic_forcing", &[4.0, 31.0, 0.3]),
    ("flexible_coupling", &[0.05, 180.0, 0.2]),
    ("input_delay", &[0.0031]),
    ("input_saturation", &[8.0]),
    ("command_derivative", &[0.02]),
    ("torque_limit", &[180.0]),
    ("load_friction", &[0.3, 0.004]),
    ("directional_friction", &[1.0, 0.8]),
    ("friction_drift", &[1.0, -0.05]),
    ("drive_dead_band", &[0.01]),
    ("speed_torque_limit", &[250.0, 30.0]),
];

/// Every effect at once, each weaker, so that none hides the others.
pub(crate) const EVERYTHING: &[(&str, &[f64])] = &[
    ("coulomb_friction", &[0.1]),
    ("stribeck_friction", &[0.05, 0.2, 0.5]),
    ("quadratic_drag", &[0.002]),
    ("cubic_stiffness", &[30.0]),
    ("asymmetric_stiffness", &[9.0]),
    ("gravity", &[60.0, 0.4]),
    ("constant_torque", &[1.5]),
    ("backlash", &[0.004]),
    ("hysteresis", &[0.3, 0.01]),
    ("end_stop", &[-0.55, 20_000.0, 0.05]),
    ("stiffness_drift", &[0.002]),
    ("damping_drift", &[0.02]),
    ("periodic_forcing", &[4.0, 31.0, 0.3]),
    ("flexible_coupling", &[0.05, 180.0, 0.2]),
    ("input_delay", &[0.0031]),
    ("input_saturation", &[8.0]),
    ("command_derivative", &[0.002]),
    ("torque_limit", &[190.0]),
    ("load_friction", &[0.05, 0.001]),
    ("directional_friction", &[0.1, 0.08]),
    ("friction_drift", &[0.1, -0.05]),
    ("drive_dead_band", &[0.004]),
    ("speed_torque_limit", &[260.0, 40.0]),
];

/// A command with a torque of up to 12 and a rising frequency, 50 samples a second.
pub(crate) fn command(duration: f64, hold: Hold) -> Input {
    let times = grid(duration, 50.0);
    let values = times.iter().map(|t| 12.0 * (19.0 * t + 0.8 * t * t).sin()).collect();
    Input::new(times, values, hold).unwrap()
}

pub(crate) fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
