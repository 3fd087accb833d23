//! Fixtures shared by the tests of both integrators.

use crate::scalar::Scalar;
use crate::{Active, Coefficients, Effect, Hold, Input, Moment, Nominal, REGISTRY, System};

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

/// Returns every effect of the system, each with the values of its example: the effect is then plain to see over 25 s at
/// 3.5 Hz from 0.7 rad.
pub(crate) fn cases() -> Vec<(&'static str, &'static [f64])> {
    let in_system = REGISTRY.iter().filter(|effect| matches!(effect, Effect::System(_)));
    in_system.map(|effect| (effect.id(), effect.description().example)).collect()
}

/// Values at which an effect hides none of the others, where its example would.
const WEAKER: &[(&str, &[f64])] = &[
    ("coulomb_friction", &[0.1]),
    ("stribeck_friction", &[0.05, 0.2, 0.5]),
    ("quadratic_drag", &[0.002]),
    ("cubic_stiffness", &[30.0]),
    ("asymmetric_stiffness", &[9.0]),
    ("gravity", &[60.0, 0.4]),
    ("constant_torque", &[1.5]),
    ("backlash", &[0.004]),
    ("hysteresis", &[0.3, 0.01, 0.4, 1.6]),
    ("end_stop", &[-0.55, 20_000.0, 0.05]),
    ("command_derivative", &[0.002]),
    ("torque_limit", &[190.0]),
    ("load_friction", &[0.05, 0.001]),
    ("directional_friction", &[0.1, 0.08]),
    ("friction_drift", &[0.1, -0.05]),
    ("drive_dead_band", &[0.004]),
    ("speed_torque_limit", &[260.0, 40.0]),
];

/// Returns every effect of the system at once, so weak that none hides the others.
pub(crate) fn everything() -> Vec<(&'static str, &'static [f64])> {
    let weaker = |id: &str| WEAKER.iter().find(|(other, _)| *other == id);
    cases().into_iter().map(|case| *weaker(case.0).unwrap_or(&case)).collect()
}

/// A command with a torque of up to 12 and a rising frequency, 50 samples a second.
pub(crate) fn command(duration: f64, hold: Hold) -> Input {
    let times = grid(duration, 50.0);
    let values = times.iter().map(|t| 12.0 * libm::sin(19.0 * t + 0.8 * t * t)).collect();
    Input::new(times, values, hold).unwrap()
}

pub(crate) fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A moment with one of its twelve variables shifted.
pub(crate) fn moment<S: Scalar>(
    position: f64,
    velocity: f64,
    region: i8,
    shift: S,
    which: usize,
) -> Moment<S> {
    let number = |index: usize, value: f64| {
        let value = S::from(value);
        if index == which { value + shift } else { value }
    };
    Moment {
        time: number(0, 2.3),
        position: number(1, position),
        velocity: number(2, velocity),
        input: number(3, 1.7),
        input_rate: number(11, 0.8),
        hidden: [number(4, 0.3), number(5, -0.8)],
        nominal: Coefficients {
            inertia: number(6, 1.4),
            damping: number(7, 0.6),
            stiffness: number(8, 5.0),
            rest_angle: number(9, 0.1),
            input_gain: number(10, 1.0),
        },
        direction: if velocity < 0.0 { -1.0 } else { 1.0 },
        region,
    }
}

/// A moment of a system in motion.
pub(crate) fn at(position: f64, velocity: f64, region: i8) -> Moment<f64> {
    moment(position, velocity, region, 0.0, usize::MAX)
}
