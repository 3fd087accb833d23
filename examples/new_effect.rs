//! Walks through the recipe for a new effect: a damping that grows away from the middle, −c·θ̇·sin²θ.
//!
//! An effect is an entry of the registry and cannot be added from outside of the workspace. This example
//! simulates a record of a system with an effect that the program does not know, and prints the diagnosis of
//! that record. Then it prints the steps and the files that add the effect; its reference is in
//! `literature.bib` already. The test
//! `recipe::a_new_estimator_takes_four_files_and_a_new_effect_eight_places` follows the same steps with the same
//! files in a copy of the workspace.
//!
//!     cargo run -p ringdown-lab --example new_effect

#![allow(clippy::print_stdout, reason = "an example talks to its reader")]

use ringdown_lab::{Arrays, DiagnosisOptions, Error, Nominal, Origin, Record, diagnose};

// ANCHOR: record
/// Returns the new law's torque per inertia: a damping that grows away from the middle.
fn sine_drag(position: f64, velocity: f64) -> f64 {
    -0.3 * velocity * position.sin().powi(2)
}

/// Simulates a record of an arm with the new law by the classical Runge–Kutta method; values are rounded to
/// the encoder's steps.
fn record(arm: &Nominal) -> Result<Record, Error> {
    let own = arm.coefficients();
    let acceleration = |position: f64, velocity: f64| {
        -own.stiffness * position - own.damping * velocity + sine_drag(position, velocity)
    };
    let (rate, substeps, encoder) = (130.0, 16, 3e-4_f64);
    let step = 1.0 / (rate * f64::from(substeps));
    let (mut position, mut velocity) = (0.8_f64, 0.0_f64);
    let (mut times, mut values) = (Vec::new(), Vec::new());
    for sample in 0..1950 {
        times.push(f64::from(sample) / rate);
        values.push((position / encoder).round() * encoder);
        for _ in 0..substeps {
            let slope = |dx: f64, dv: f64| (velocity + dv, acceleration(position + dx, velocity + dv));
            let (x1, v1) = slope(0.0, 0.0);
            let (x2, v2) = slope(0.5 * step * x1, 0.5 * step * v1);
            let (x3, v3) = slope(0.5 * step * x2, 0.5 * step * v2);
            let (x4, v4) = slope(step * x3, step * v3);
            position += step / 6.0 * (x1 + 2.0 * x2 + 2.0 * x3 + x4);
            velocity += step / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
        }
    }
    let name = "an arm with sine drag".to_owned();
    Record::new(times, values, Arrays { name, origin: Origin::Simulated, ..Arrays::default() })
}
// ANCHOR_END: record

// ANCHOR: main
/// Steps of CONTRIBUTING.md: the file, and the text to add to it.
const STEPS: [(&str, &str); 7] = [
    ("crates/dynamics/src/effects/sine_drag.rs", include_str!("../tests/recipe/law.rs")),
    ("crates/dynamics/src/effects/mod.rs", "mod sine_drag;\npub use sine_drag::SineDrag;\n"),
    ("crates/dynamics/src/registry.rs, under `system`", "    SineDrag,\n"),
    ("crates/diagnosis/src/model/candidates/sine_drag.rs", include_str!("../tests/recipe/candidate.rs")),
    (
        "crates/diagnosis/src/model/candidates/mod.rs",
        "pub(crate) mod sine_drag;\n    Candidate::new(&sine_drag::SineDrag),\n",
    ),
    ("crates/trials/src/effects/sine_drag.rs", include_str!("../tests/recipe/trial.rs")),
    ("crates/trials/src/effects/mod.rs", "mod sine_drag;\n    sine_drag::EFFECT,\n"),
];

fn main() -> Result<(), Error> {
    let arm = Nominal::new(1.0, 0.2, 480.0, 0.0)?;
    let diagnosis = diagnose(&[record(&arm)?], &arm, &DiagnosisOptions::default())?;
    println!("Before the program knows the effect:\n{}\n", diagnosis.verdict().summary);
    for (file, text) in STEPS {
        println!("--- {file}\n{text}");
    }
    Ok(())
}
// ANCHOR_END: main
