//! Simulates an arm with and without air drag, and shows the effect of the drag on the decay.
//!
//!     cargo run -p ringdown-lab --example simulate_with_an_effect

#![allow(clippy::print_stdout, reason = "an example talks to its reader")]

use ringdown_lab::{Error, EstimateOptions, Nominal, Simulation, effects, peaks};

// ANCHOR: main
fn main() -> Result<(), Error> {
    let arm = Nominal::swinging(3.5, 0.005)?;
    let sensor =
        |simulation: Simulation| simulation.released_at(0.8).sampled(260.0, 20.0).noise(2e-4).seed(1);

    let viscous = sensor(Simulation::of(&arm)).run()?;
    let with_drag =
        sensor(Simulation::of(&arm).with_effect("quadratic_drag", &[("coefficient", 0.3)])?).run()?;

    let drag = effects().find(|effect| effect.id == "quadratic_drag");
    println!("drag adds the torque {}", drag.map_or("?", |effect| effect.equation));

    // The slope of the logarithm of the peaks is the decay rate; with drag it depends on the amplitude.
    for (name, record) in [("viscous", &viscous), ("with drag", &with_drag)] {
        let envelope = peaks(record, &EstimateOptions::default())?.envelope;
        let (times, logs) = (envelope.times_s(), envelope.log_amplitudes());
        let rate = |from: usize, to: usize| -> Option<f64> {
            Some((logs.get(from)? - logs.get(to)?) / (times.get(to)? - times.get(from)?))
        };
        let last = envelope.len() - 1;
        let [early, late] = [rate(0, last / 4), rate(last / 2, last)].map(Option::unwrap_or_default);
        println!("{name}: decay rate {early:.3} 1/s in the first quarter, {late:.3} 1/s in the second half");
    }
    Ok(())
}
// ANCHOR_END: main
