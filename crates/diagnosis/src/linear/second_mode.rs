//! Search for a second body on a spring in a driven record, to first order.
//!
//! A body of inertia J, tied to the first by a spring and a damper of its own, moves by δ against it:
//! δ̈ + 2·r·δ̇ + ω²·δ = −θ̈, and pulls at it with J·(ω²·δ + 2·r·δ̇). Along an observed motion θ this torque
//! is J times a known function of ω and r. A record that is released once shows a second mode as a decaying
//! line. A record that is driven throughout shows it wherever the input has power, and not as a line.

use crate::data::segments::Data;
use crate::linear::projection::Projection;
use crate::linear::tangent::{Path, Step, matrix, stack};
use crate::model::candidates::Mode;
use crate::residual::spectrum::that_lie_apart;
use nalgebra::{DMatrix, Vector2};

/// Ratio of neighboring frequencies on the grid of second bodies.
const FINE: f64 = 1.03;

/// Decay rate of the second body relative to its frequency; the line is then about as wide as a step of the
/// grid.
const WIDTH: f64 = 0.02;

/// Ratio of frequencies above which two modes count as different.
const APART: f64 = 1.1;

/// Returns the `most` second bodies with the largest gains, best first; none for records without an input.
///
/// `residual` is projected on what the fit cannot move.
pub(crate) fn driven_modes(
    data: &Data,
    paths: &[Path],
    projection: &Projection,
    residual: &DMatrix<f64>,
    most: usize,
) -> Vec<Mode> {
    if !data.inputs.iter().any(Option::is_some) {
        return Vec::new();
    }
    let [slowest, fastest] = data.facts.modes();
    let count = (libm::log(fastest / slowest) / libm::log(FINE)).floor() as i32;
    let frequencies: Vec<f64> = (0..=count).map(|step| slowest * FINE.powi(step)).collect();
    let columns: Vec<Vec<f64>> = frequencies
        .iter()
        .map(|frequency| {
            stack(paths, |path| path.response(&pull(path, *frequency, WIDTH * frequency), data.quantity))
        })
        .collect();
    let mut columns = matrix(projection.rows(), &columns);
    projection.apply(&mut columns);
    let mut modes: Vec<Mode> = frequencies
        .iter()
        .zip(columns.column_iter())
        .filter_map(|(&frequency, column)| {
            let score = column.dot(&residual.column(0));
            let inertia = score / column.norm_squared();
            let gain = score * inertia;
            (inertia > 0.0 && gain.is_finite()).then_some(Mode {
                frequency,
                rate: WIDTH * frequency,
                inertia: Some(inertia),
                gain,
            })
        })
        .collect();
    modes.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let ratio = |one: &Mode, other: &Mode| libm::log(one.frequency / other.frequency).abs();
    that_lie_apart(modes, |one, other| ratio(one, other) > libm::log(APART), most)
}

/// Returns the torque of a second body of inertia 1 on the first along a path, at whose beginning both move
/// together. The acceleration is linear between samples.
fn pull(path: &Path, frequency: f64, rate: f64) -> Vec<f64> {
    let stiffness = frequency * frequency;
    let forces: Vec<f64> = path.motion.acceleration.iter().map(|acceleration| -acceleration).collect();
    let mut state = Vector2::zeros();
    let mut torque = Vec::with_capacity(path.len());
    let mut next = path.times.iter().zip(&forces).skip(1);
    let mut step = Step::of(0.0, stiffness, 2.0 * rate, 1.0);
    let mut size = 0.0;
    for (time, force) in path.times.iter().zip(&forces) {
        torque.push(stiffness * state.x + 2.0 * rate * state.y);
        let Some((after, later)) = next.next() else { break };
        // On an even clock all steps are the same.
        if (after - time - size).abs() > 1e-9 * size {
            size = after - time;
            step = Step::of(size, stiffness, 2.0 * rate, 1.0);
        }
        state = step.after(state, *force, *later);
    }
    torque
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::predictor::Motion;

    /// At a steady swing θ = sin Ωt the torque settles to the imaginary part of
    /// (ω² + 2irΩ)·Ω²/(ω² − Ω² + 2irΩ)·exp(iΩt).
    #[test]
    fn the_pull_is_that_of_the_second_bodys_equation() {
        let (swing, frequency, rate) = (20.0_f64, 31.0, 1.5);
        let times: Vec<f64> = (0..4000).map(|index| f64::from(index) * 2e-3).collect();
        let position: Vec<f64> = times.iter().map(|time| (swing * time).sin()).collect();
        let path = Path::of_motion(
            times.clone(),
            Motion {
                velocity: times.iter().map(|time| swing * (swing * time).cos()).collect(),
                acceleration: position.iter().map(|x| -swing * swing * x).collect(),
                position,
            },
        );
        let torque = pull(&path, frequency, rate);
        let (near, own) = (frequency * frequency - swing * swing, 2.0 * rate * swing);
        let (stiff, square) = (frequency * frequency, near * near + own * own);
        // (a + ib)/(c + ib) with a = ω², b = 2rΩ, c = ω² − Ω².
        let (in_phase, ahead) = ((stiff * near + own * own) / square, own * (near - stiff) / square);
        for (time, torque) in times.iter().zip(&torque).skip(3500) {
            let (sine, cosine) = (swing * time).sin_cos();
            let expected = swing * swing * (in_phase * sine + ahead * cosine);
            assert!((torque - expected).abs() < 2e-3 * swing * swing, "{time}: {torque} {expected}");
        }
    }
}
