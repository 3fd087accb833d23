//! Cost of a motion: a 25 s record at 260 Hz of a 3.5 Hz oscillator released at 0.7 rad.
//!
//!     cargo bench -p dynamics
//!
//! Every result is checked against the reference integrator before it is timed.

#![allow(missing_docs, clippy::unwrap_used, clippy::indexing_slicing, reason = "a benchmark")]

use divan::{Bencher, black_box};
use dynamics::reference::{Tolerance, simulate};
use dynamics::sensitivity::{Free, FullState, Model, Response, Settings};
use dynamics::{Active, Nominal, Start, System};

fn main() {
    divan::main();
}

fn times() -> Vec<f64> {
    (0..6500).map(|i| f64::from(i) / 260.0).collect()
}

fn system() -> System {
    let omega = 7.0 * std::f64::consts::PI;
    let nominal = Nominal::new(1.0, 2.0 * 0.006 * omega, omega * omega, 0.01).unwrap();
    let effects = vec![
        Active::new("coulomb_friction", &[0.3]).unwrap(),
        Active::new("quadratic_drag", &[0.01]).unwrap(),
        Active::new("gravity", &[40.0, 0.2]).unwrap(),
    ];
    System::new(nominal, effects).unwrap()
}

const START: Start = Start::release(0.7);

fn effect(id: &'static str, parameter: &'static str) -> Free {
    Free::Effect { id, parameter }
}

/// Ten free quantities: three nominal ones, five of effects, the start.
fn ten() -> Vec<Free> {
    vec![
        Free::Damping,
        Free::Stiffness,
        Free::RestAngle,
        effect("coulomb_friction", "torque"),
        effect("quadratic_drag", "coefficient"),
        effect("gravity", "torque"),
        effect("gravity", "angle"),
        effect("cubic_stiffness", "coefficient"),
        Free::StartPosition,
        Free::StartVelocity,
    ]
}

fn with_cubic() -> System {
    let plain = system();
    let mut effects = plain.effects().to_vec();
    effects.push(Active::new("cubic_stiffness", &[20.0]).unwrap());
    System::new(*plain.nominal(), effects).unwrap()
}

/// Runs the model on the whole record and compares it with the reference.
fn checked(system: &System, free: &[Free]) -> (Model, Vec<f64>, Response) {
    let times = times();
    let exact = simulate(system, START, None, &times, &Tolerance::default()).unwrap();
    let mut model = Model::new(system, free, Settings::default()).unwrap();
    let response = model.run(START.into(), None, &times).unwrap();
    let worst = response.position.iter().zip(&exact.position);
    let worst = worst.map(|(own, exact)| (own - exact).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-9, "{worst:e}");
    (model, times, response)
}

#[divan::bench]
fn reference(bencher: Bencher<'_, '_>) {
    let (system, times) = (system(), times());
    let tolerance = Tolerance::default();
    bencher.bench(|| simulate(black_box(&system), START, None, &times, &tolerance).unwrap());
}

#[divan::bench]
fn motion_alone(bencher: Bencher<'_, '_>) {
    let (mut model, times, mut response) = checked(&with_cubic(), &[]);
    bencher.bench_local(|| model.run_into(black_box(START.into()), None, &times, &mut response).unwrap());
}

#[divan::bench]
fn ten_sensitivities(bencher: Bencher<'_, '_>) {
    let (mut model, times, mut response) = checked(&with_cubic(), &ten());
    bencher.bench_local(|| model.run_into(black_box(START.into()), None, &times, &mut response).unwrap());
}

/// The same record cut into segments of 4 periods, each with its own start, as for multiple shooting.
#[divan::bench]
fn ten_sensitivities_in_segments(bencher: Bencher<'_, '_>) {
    let (mut model, times, response) = checked(&with_cubic(), &ten());
    let whole = Model::new(&with_cubic(), &[], Settings { velocity: true, ..Settings::default() })
        .unwrap()
        .run(START.into(), None, &times)
        .unwrap();
    let segments: Vec<(FullState, &[f64])> = times
        .chunks(297)
        .enumerate()
        .map(|(number, chunk)| {
            let (position, velocity) = (whole.position[297 * number], whole.velocity[297 * number]);
            (FullState { position, velocity, hidden: None }, chunk)
        })
        .collect();
    let mut part = Response::default();
    for (number, (start, chunk)) in segments.iter().enumerate() {
        model.run_into(*start, None, chunk, &mut part).unwrap();
        for (own, exact) in part.position.iter().zip(&response.position[297 * number..]) {
            assert!((own - exact).abs() < 1e-9);
        }
    }
    bencher.bench_local(|| {
        for (start, chunk) in black_box(&segments) {
            model.run_into(*start, None, chunk, &mut part).unwrap();
        }
    });
}
