use super::{Free, FullState, Model, Settings};
use crate::reference::{Tolerance, simulate};
use crate::{Active, Hold, Input, Nominal, Start, System};

fn grid(duration: f64, rate: f64) -> Vec<f64> {
    (0..=(duration * rate) as usize).map(|i| i as f64 / rate).collect()
}

fn nominal() -> Nominal {
    let omega = 7.0 * std::f64::consts::PI;
    Nominal::new(1.0, 2.0 * 0.006 * omega, omega * omega, 0.02).unwrap()
}

/// One strength for each effect, large enough to matter over 25 s at 3.5 Hz from 0.7 rad.
const CASES: &[(&str, &[f64])] = &[
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
];

fn command(duration: f64, hold: Hold) -> Input {
    let times = grid(duration, 50.0);
    let values = times.iter().map(|t| 12.0 * (19.0 * t + 0.8 * t * t).sin()).collect();
    Input::new(times, values, hold).unwrap()
}

fn system(effects: &[(&str, &[f64])]) -> System {
    let active = effects.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect();
    System::new(nominal(), active).unwrap()
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn trajectories_are_the_references_for_every_effect() {
    let times = grid(25.0, 260.0);
    let settings = Settings { velocity: true, acceleration: true, ..Settings::default() };
    for case in CASES {
        for hold in [Hold::Zero, Hold::Linear] {
            let driven = case.0.starts_with("input");
            if !driven && hold == Hold::Linear {
                continue;
            }
            let input = driven.then(|| command(25.0, hold));
            let system = system(&[*case]);
            let start = Start::release(0.7);
            let exact = simulate(&system, start, input.as_ref(), &times, &Tolerance::default()).unwrap();
            let mut model = Model::new(&system, &[], settings).unwrap();
            let response = model.run(start.into(), input.as_ref(), &times).unwrap();
            let worst = difference(&response.position, &exact.position);
            let speed = difference(&response.velocity, &exact.velocity);
            assert!(worst < 1e-8, "{}: {worst:e}", case.0);
            assert!(speed < 1e-6, "{}: {speed:e}", case.0);
        }
    }
}

/// Every quantity of a system that can be free.
fn everything_free(system: &System) -> Vec<Free> {
    let nominal = [Free::Inertia, Free::Damping, Free::Stiffness, Free::RestAngle, Free::InputGain];
    let effects = system.effects().iter().flat_map(|active| {
        let description = active.effect().description();
        description
            .parameters
            .iter()
            .map(|parameter| Free::Effect { id: description.id, parameter: parameter.name })
    });
    nominal.into_iter().chain(effects).chain([Free::StartPosition, Free::StartVelocity]).collect()
}

/// The system and start with one quantity moved.
fn moved(system: &System, start: Start, free: Free, by: f64) -> (System, Start) {
    let mut coefficients = system.nominal().coefficients();
    let mut start = start;
    let mut effects = system.effects().to_vec();
    match free {
        Free::Inertia => coefficients.inertia += by,
        Free::Damping => coefficients.damping += by,
        Free::Stiffness => coefficients.stiffness += by,
        Free::RestAngle => coefficients.rest_angle += by,
        Free::InputGain => coefficients.input_gain += by,
        Free::StartPosition => start.position += by,
        Free::StartVelocity => start.velocity += by,
        Free::StartHidden(_) => panic!("hidden states have a test of their own"),
        Free::Effect { id, parameter } => {
            let active = effects.iter_mut().find(|active| active.id() == id).unwrap();
            let index = active.effect().description().parameter_index(parameter).unwrap();
            let mut values = active.values().to_vec();
            values[index] += by;
            *active = Active::new(id, &values).unwrap();
        }
    }
    let nominal = system.nominal().with_coefficients(coefficients).unwrap();
    (System::new(nominal, effects).unwrap(), start)
}

/// The size of an effect's parameter; other quantities may be moved as far as one likes, but for the gain: a
/// held input passes the edge of saturation at once.
fn size(system: &System, free: Free) -> f64 {
    if free == Free::InputGain {
        return 0.1;
    }
    let Free::Effect { id, parameter } = free else { return f64::INFINITY };
    system.effects().iter().find(|active| active.id() == id).unwrap().value(parameter).unwrap().abs()
}

/// The sixth-order central difference of a list of numbers.
fn central(step: f64, mut at: impl FnMut(f64) -> Vec<f64>) -> Vec<f64> {
    let mut sum: Vec<f64> = Vec::new();
    for (distance, weight) in [(1.0, 0.75), (2.0, -0.15), (3.0, 1.0 / 60.0)] {
        for side in [-1.0, 1.0] {
            let values = at(side * distance * step);
            sum.resize(values.len(), 0.0);
            for (sum, value) in sum.iter_mut().zip(values) {
                *sum += side * weight * value / step;
            }
        }
    }
    sum
}

const EXACT: Settings =
    Settings { tolerance: 1e-15, degree: 16, velocity: true, acceleration: true, most_steps: 1_000_000 };

/// Compares every column of position, velocity and acceleration with differences of the model itself and of
/// the reference. Samples at which an event passes while a quantity is moved are left out: the motion has a
/// kink there.
fn check_columns(name: &str, system: &System, start: Start, input: Option<&Input>, times: &[f64], bar: f64) {
    let free = everything_free(system);
    let columns = free.len();
    let tight = Tolerance { relative: 1e-14, ..Tolerance::default() };
    let exact = simulate(system, start, input, times, &tight).unwrap();
    let delay = system.input_delay();
    let knots = input.map(|input| input.times().to_vec()).unwrap_or_default();
    let kinks: Vec<f64> =
        exact.events.iter().map(|event| event.time).chain(knots.iter().map(|knot| knot + delay)).collect();
    let clear: Vec<bool> =
        times.iter().map(|time| kinks.iter().all(|kink| (kink - time).abs() > 1e-3)).collect();
    assert!(clear.iter().filter(|clear| **clear).count() > times.len() / 3, "{name}");
    let mut model = Model::new(system, &free, EXACT).unwrap();
    let response = model.run(start.into(), input, times).unwrap();
    for (column, quantity) in free.iter().enumerate() {
        if input.is_none() && *quantity == Free::InputGain {
            continue;
        }
        let of = |list: &[f64]| -> Vec<f64> { list.iter().skip(column).step_by(columns).copied().collect() };
        let own = [
            of(&response.position_sensitivity),
            of(&response.velocity_sensitivity),
            of(&response.acceleration_sensitivity),
        ];
        let largest = |list: &[f64]| list.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        assert!(largest(&own[0]) > 0.0, "{name}: {quantity:?} has no influence");
        // As large as keeps events within the time left out, and differences clear of rounding.
        let step = (1e-3 / largest(&own[0])).min(0.002 * size(system, *quantity));
        let together = |position: Vec<f64>, velocity: Vec<f64>, acceleration: Vec<f64>| {
            [position, velocity, acceleration].concat()
        };
        let itself = central(step, |by| {
            let (system, start) = moved(system, start, *quantity, by);
            let response = Model::new(&system, &[], EXACT).unwrap().run(start.into(), input, times).unwrap();
            together(response.position, response.velocity, response.acceleration)
        });
        let reference = central(step, |by| {
            let (system, start) = moved(system, start, *quantity, by);
            let motion = simulate(&system, start, input, times, &tight).unwrap();
            together(motion.position, motion.velocity, motion.acceleration)
        });
        for (what, other) in [("itself", itself), ("the reference", reference)] {
            for (order, (own, other)) in own.iter().zip(other.chunks(times.len())).enumerate() {
                let worst = own.iter().zip(other).zip(&clear).filter(|(_, clear)| **clear);
                let worst = worst.map(|((own, other), _)| (own - other).abs()).fold(0.0, f64::max);
                let relative = worst / largest(own);
                assert!(
                    relative < bar,
                    "{name}: {quantity:?}, derivative {order} against {what}: {relative:e}"
                );
            }
        }
    }
}

#[test]
fn columns_are_the_derivatives_for_every_effect_through_its_events() {
    let times = grid(3.0, 130.0);
    let start = Start { position: 0.6, velocity: 2.0 };
    for case in CASES {
        for hold in [Hold::Zero, Hold::Linear] {
            let driven = case.0.starts_with("input");
            if !driven && hold == Hold::Linear {
                continue;
            }
            let input = driven.then(|| command(3.0, hold));
            check_columns(case.0, &system(&[*case]), start, input.as_ref(), &times, 1e-7);
        }
    }
}
