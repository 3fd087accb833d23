//! Inner loop of a joint in a diagnosis: ratios to its gain, and numbers that are as uncertain as the gain.
//!
//! Command and motion of a joint without a measured torque tell every torque relative to the gain of its loop: gains a
//! factor of four apart explain them equally well. So a gain that is not known makes every torque uncertain by the
//! same factor, and only the ratios are told by the records.

use dynamics::{Command, Stated};
use experiment::Servo;
use results::{ActuatorRow, DiagnosisResult, GainRow, RatioRow, WithInterval};
use std::collections::BTreeMap;

/// Units of torques and coefficients, each with its unit over the gain of a position and of a velocity.
const OVER_GAIN: [(&str, &str, &str); 10] = [
    ("N m", "rad", "rad/s"),
    ("N m s/rad", "s", "1"),
    ("N m/rad", "1", "1/s"),
    ("kg m^2", "s^2", "s"),
    ("N m s^2/rad^2", "s^2/rad", "s/rad"),
    ("N m/rad^3", "1/rad^2", "1/(rad^2 s)"),
    ("N", "m", "m/s"),
    ("N s/m", "s", "1"),
    ("N/m", "1", "1/s"),
    ("kg", "s^2", "s"),
];

/// Returns the unit of a number over the gain; `None` if the number does not scale with the gain.
fn over_gain(unit: &str, command: Command) -> Option<&'static str> {
    let (_, position, velocity) = OVER_GAIN.iter().find(|(own, ..)| *own == unit)?;
    match command {
        Command::Position => Some(position),
        Command::Velocity => Some(velocity),
        Command::Torque => None,
    }
}

/// Adds what the records tell of the loop, and widens the intervals of torques by the tolerance of its gain.
pub(crate) fn add(result: &mut DiagnosisResult, servo: &Servo, gain: f64) {
    let command = servo.actuator.command;
    let stated = match command {
        Command::Position => servo.actuator.proportional,
        Command::Velocity => servo.actuator.derivative,
        Command::Torque => Stated::Known(gain),
    };
    let mut ratios = BTreeMap::new();
    let mut ratio = |name: String, estimate: WithInterval, unit: &str| {
        if let Some(unit) = over_gain(unit, command) {
            let interval_95 = estimate.interval_95.map(|end| end / gain);
            let estimate = WithInterval { value: estimate.value / gain, interval_95 };
            ratios.insert(name, RatioRow { estimate, unit: unit.to_owned() });
        }
    };
    for (name, row) in result.calibration.rows() {
        if let Some(repaired) = row.repaired {
            ratio(name, repaired, &row.unit);
        }
    }
    let stiffness = result.calibration.stiffness.repaired.map(|own| own.value);
    if let (Command::Position, Some(rest), Some(stiffness)) =
        (command, result.calibration.rest_angle.repaired, stiffness)
    {
        // Where a position loop rests off its command, a constant load holds it.
        let interval_95 = rest.interval_95.map(|end| end * stiffness);
        ratio("load".to_owned(), WithInterval { value: rest.value * stiffness, interval_95 }, "N m");
    }
    for effect in &result.effects {
        for (name, row) in effect.parameters.iter().filter(|(_, row)| row.determined) {
            let estimate = WithInterval { value: row.value, interval_95: row.interval_95 };
            ratio(format!("{}.{name}", effect.id), estimate, &row.unit);
        }
    }
    let (word, tolerance) = match stated {
        Stated::Known(_) => ("known", None),
        Stated::About { tolerance, .. } => ("about", Some(tolerance)),
        Stated::Unknown => ("unknown", None),
    };
    let unit = if command == Command::Velocity { "N m s/rad" } else { "N m/rad" };
    let row = GainRow { value: gain, unit: unit.to_owned(), stated: word.to_owned(), tolerance };
    result.actuator = Some(ActuatorRow { kind: command.name().to_owned(), gain: row, ratios });
    // An unknown gain may be any: the stated intervals are those beside the gain that the answer assumes.
    if let Some(tolerance) = tolerance {
        widen(result, command, tolerance / gain);
    }
}

/// Widens the intervals of all torques and coefficients by a relative tolerance.
fn widen(result: &mut DiagnosisResult, command: Command, relative: f64) {
    let wider = |value: f64, interval: &mut [f64; 2]| {
        let own = value.abs() * relative;
        let [low, high] = *interval;
        *interval = [value - libm::hypot(value - low, own), value + libm::hypot(high - value, own)];
    };
    for parameter in result.effects.iter_mut().flat_map(|effect| effect.parameters.values_mut()) {
        if over_gain(&parameter.unit, command).is_some() {
            wider(parameter.value, &mut parameter.interval_95);
        }
    }
    let own = &mut result.calibration;
    for row in [&mut own.inertia, &mut own.damping, &mut own.stiffness] {
        for estimate in [&mut row.recalibrated, &mut row.repaired].into_iter().flatten() {
            wider(estimate.value, &mut estimate.interval_95);
        }
    }
}
