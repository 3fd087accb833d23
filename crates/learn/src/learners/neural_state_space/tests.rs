//! Sensitivities, and free runs on simulated systems.

use super::network::{Shape, Wiring};
use crate::judge::{runs, score};
use crate::testing::{context, data_set, drag_and_cubic, learner};
use seed::Seed;

#[test]
fn sensitivities_are_the_derivatives_of_a_free_run() {
    for wiring in [Wiring::Chain, Wiring::Full] {
        let shape = Shape { wiring, states: 3, inputs: 1, units: 2, step: 0.2 };
        let mut weights = shape.drawn(&Seed::new(1));
        weights.iter_mut().enumerate().for_each(|(at, own)| *own += 0.2 * (at as f64).sin());
        let inputs: Vec<f64> = (0..20).map(|at| (0.3 * f64::from(at)).cos()).collect();
        let start = [0.3, -0.2, 0.1];
        let last =
            |weights: &[f64], start: &[f64]| shape.run(weights, start, &inputs, 20, false).states[19 * 3];
        let slopes = shape.run(&weights, &start, &inputs, 20, true).slopes;
        let columns = weights.len() + 3;
        for (column, own) in slopes[19 * columns..].iter().enumerate() {
            let moved = |by: f64| {
                let (mut weights, mut start) = (weights.clone(), start);
                match column.checked_sub(weights.len()) {
                    None => weights[column] += by,
                    Some(state) => start[state] += by,
                }
                last(&weights, &start)
            };
            let expected = (moved(1e-6) - moved(-1e-6)) / 2e-6;
            assert!(
                (own - expected).abs() < 1e-7 * expected.abs().max(1.0),
                "{wiring:?} {column}: {own} {expected}"
            );
        }
    }
}

#[test]
fn a_state_carried_through_the_run_predicts_a_driven_system() {
    let data = data_set(&drag_and_cubic(), true, 2e-3);
    let quick = ["members=2", "states=2", r#"wirings=["full"]"#, "samples=1500"];
    let fitted = learner("neural-state-space", &quick).fit(&data, &context()).unwrap();
    let scores = score(fitted.model.as_ref(), &runs(fitted.model.as_ref(), &data), &data);
    assert!(scores.free_run_rmse < 0.1 * data.scale.position, "{scores:?} {}", data.scale.position);
    assert!(fitted.model.validation().is_some());
}
