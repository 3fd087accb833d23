//! The signature of an effect: two panels from simulated records with and without it.

use crate::plot::Panel;
use dynamics::{Class, Description, Kind};
use ringdown_lab::{Error, Excitation, Nominal, Record, Simulation, Waveform};

/// Strengths, per unit of inertia, that a plot shows better than the effect's own example.
const STRENGTHS: &[(&str, &[f64])] = &[
    ("stribeck_friction", &[0.5, 2.0, 1.0]),
    ("quadratic_drag", &[0.2]),
    ("hysteresis", &[2.0, 0.05]),
    ("cubic_stiffness", &[-60.0]),
    ("constant_torque", &[30.0]),
    ("end_stop", &[0.45, 20_000.0, 0.05]),
    ("stiffness_drift", &[0.004]),
    ("damping_drift", &[0.1]),
    ("periodic_forcing", &[4.0, 26.0, 0.3]),
    ("flexible_coupling", &[0.05, 40.0, 0.2]),
    ("input_delay", &[0.03]),
    ("input_saturation", &[40.0]),
    ("torque_limit", &[90.0]),
    ("load_friction", &[1.0, 0.05]),
    ("directional_friction", &[1.0, 1.5]),
    ("friction_drift", &[2.0, -0.2]),
    ("drive_dead_band", &[0.05]),
    ("speed_torque_limit", &[120.0, 6.0]),
];

const RATE_HZ: f64 = 260.0;

/// The panels of an effect.
pub(crate) fn panels(effect: &Description) -> Result<[Panel; 2], Error> {
    let values =
        STRENGTHS.iter().find(|(id, _)| *id == effect.id).map_or(effect.example, |(_, values)| values);
    let parameters: Vec<(&str, f64)> =
        effect.parameters.iter().map(|own| own.name).zip(values.iter().copied()).collect();
    let nominal = Nominal::swinging(3.5, 0.006)?;
    let plain = Simulation::of(&nominal).released_at(0.7).sampled(RATE_HZ, 25.0);
    let plain = if effect.driven_only {
        let (amplitude, frequency_hz) = (60.0, 1.5);
        plain.starting(0.0, 0.0).driven_by(Excitation {
            waveform: Waveform::Square,
            amplitude,
            frequency_hz,
            end_frequency_hz: frequency_hz,
        })
    } else {
        plain
    };
    let without = plain.run()?;
    let with = plain.with_effect(effect.id, &parameters)?.run()?;
    Ok(match (effect.kind, effect.driven_only) {
        (Kind::System, false) => swings(&without, &with),
        (Kind::System, true) => [motion(&without, &with, 2.0, false), difference(&without, &with, 2.0)],
        (Kind::MeasuringChain, _) => {
            let second = if effect.class == Class::Clock || with.len() != without.len() {
                stamps(&without, &with)
            } else {
                difference(&without, &with, 1.2)
            };
            [motion(&without, &with, 1.2, true), second]
        }
    })
}

/// Amplitude over time, and frequency over amplitude, from the turning points.
fn swings(without: &Record, with: &Record) -> [Panel; 2] {
    let own = [without, with].map(half_swings);
    let amplitudes = |points: &[[f64; 3]]| points.iter().map(|[time, size, _]| (*time, *size)).collect();
    let frequencies = |points: &[[f64; 3]]| points.iter().map(|[_, size, hz]| (*size, *hz)).collect();
    let [without, with] = &own;
    let panel = Panel {
        title: "amplitude",
        x: "time, s",
        y: "rad",
        is_log: true,
        has_dots: false,
        without: amplitudes(without),
        with: amplitudes(with),
    };
    let second = Panel {
        title: "frequency",
        x: "amplitude, rad",
        y: "Hz",
        is_log: false,
        has_dots: false,
        without: frequencies(without),
        with: frequencies(with),
    };
    [panel, second]
}

/// Time, amplitude and frequency of every half swing larger than a hundredth of a radian.
fn half_swings(record: &Record) -> Vec<[f64; 3]> {
    let points: Vec<(f64, f64)> =
        record.stamps_s().iter().copied().zip(record.values().iter().copied()).collect();
    let turning: Vec<(f64, f64)> = points
        .windows(3)
        .filter_map(|window| {
            let [(_, before), (time, at), (_, after)] = *window else { return None };
            let curvature = before - 2.0 * at + after;
            if (at - before) * (after - at) > 0.0 || curvature == 0.0 {
                return None;
            }
            // The vertex of the parabola through the three.
            let shift = 0.5 * (before - after) / curvature;
            Some((time + shift / RATE_HZ, at - 0.25 * (before - after) * shift))
        })
        .collect();
    turning
        .windows(3)
        .filter_map(|window| {
            let [(first, one), (time, two), (last, three)] = *window else { return None };
            let size = 0.5 * (two - 0.5 * (one + three)).abs();
            (size > 0.01).then_some([time, size, 1.0 / (last - first)])
        })
        .collect()
}

fn window(record: &Record, seconds: f64) -> Vec<(f64, f64)> {
    let points = record.stamps_s().iter().copied().zip(record.values().iter().copied());
    points.take_while(|(time, _)| *time < seconds).collect()
}

fn motion(without: &Record, with: &Record, seconds: f64, has_dots: bool) -> Panel {
    Panel {
        title: "record",
        x: "time, s",
        y: "rad",
        is_log: false,
        has_dots,
        without: window(without, seconds),
        with: window(with, seconds),
    }
}

fn difference(without: &Record, with: &Record, seconds: f64) -> Panel {
    let points = window(without, seconds).into_iter().zip(with.values());
    Panel {
        title: "what the effect changes",
        x: "time, s",
        y: "rad",
        is_log: false,
        has_dots: false,
        without: Vec::new(),
        with: points.map(|((time, plain), value)| (time, value - plain)).collect(),
    }
}

/// Times from sample to sample.
fn stamps(without: &Record, with: &Record) -> Panel {
    let steps = |record: &Record| {
        let pairs = record.stamps_s().iter().zip(record.stamps_s().iter().skip(1)).take(300);
        pairs.map(|(one, next)| (*one, 1e3 * (next - one))).collect()
    };
    Panel {
        title: "time to the next sample",
        x: "time, s",
        y: "ms",
        is_log: false,
        has_dots: true,
        without: steps(without),
        with: steps(with),
    }
}
