//! Integration of a law from sample to sample, by the Runge–Kutta method of order four.

use super::law::{Law, State};
use crate::LearnError;
use crate::data::Trajectory;
use crate::flow::Running;
use dynamics::Input;

/// Fewest steps from a sample to the next.
const FEWEST_STEPS: f64 = 4.0;

/// Longest step, in those of a law whose torque may jump.
const STEPS: f64 = 2.0;

/// Stretch to be predicted: times, observations, and the input between them.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub(super) times_s: Vec<f64>,
    pub(super) values: Vec<f64>,
    pub(super) input: Option<Input>,
}

impl Piece {
    /// Takes over the samples of a trajectory.
    pub(super) fn new(part: &Trajectory, running: &Running) -> Result<Self, LearnError> {
        let given = |input: &[f64]| Input::new(part.times_s().to_vec(), input.to_vec(), running.hold);
        let input = part.input().map(given).transpose()?;
        Ok(Self { times_s: part.times_s().to_vec(), values: part.values().to_vec(), input })
    }
}

/// Free run of a law.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    /// Observed quantity at each time. From a divergence on, the bound.
    pub(super) positions: Vec<f64>,
    /// Hidden state at each time. From a divergence on there is none.
    pub(super) hidden: Vec<f64>,
    /// Time at which the run diverged, in seconds after its start.
    pub(super) diverged_s: Option<f64>,
}

/// Law that can be run from sample to sample. A method of the trait, so that the steps are compiled for each law.
pub(super) trait Runnable: Law {
    /// Runs the law from a start state over the times of a piece.
    fn motion(&self, parameters: &[f64], start: State, piece: &Piece, running: &Running) -> Motion;
}

impl<L: Law> Runnable for L {
    fn motion(&self, parameters: &[f64], start: State, piece: &Piece, running: &Running) -> Motion {
        let mut state = self.limited(parameters, start);
        let first = self.observed(parameters, state);
        let mut found = Motion { positions: vec![first], hidden: vec![self.hidden(state)], diverged_s: None };
        found.positions.reserve(piece.times_s.len());
        let pairs = piece.times_s.iter().zip(piece.times_s.iter().skip(1)).enumerate();
        for (number, (from, to)) in pairs {
            // Without an input nothing drives the system.
            let course = piece.input.as_ref().map_or([0.0; 4], |input| input.cubic(number));
            state = interval(self, parameters, state, (to - from, course), running.longest_step_s);
            let observed = self.observed(parameters, state);
            if observed.is_nan() || observed.abs() > running.bound {
                // Only used in an error message.
                found.diverged_s = Some(to - piece.times_s.first().copied().unwrap_or_default());
                found.positions.resize(piece.times_s.len(), running.bound);
                return found;
            }
            found.positions.push(observed);
            found.hidden.push(self.hidden(state));
        }
        found
    }
}

/// Advances a state over a sampling interval. The input is a polynomial in the time.
fn interval(
    law: &impl Law,
    parameters: &[f64],
    mut state: State,
    (length, [a, b, c, d]): (f64, [f64; 4]),
    longest_step_s: f64,
) -> State {
    let steps = (length / (STEPS * longest_step_s) - 1e-9).ceil().max(FEWEST_STEPS);
    let step = length / steps;
    let input = |time: f64| a + time * (b + time * (c + time * d));
    for number in 0..steps as usize {
        let from = number as f64 * step;
        let (now, middle, end) = (input(from), input(from + 0.5 * step), input(from + step));
        let k1 = law.rate(parameters, state, now);
        let k2 = law.rate(parameters, moved(state, k1, 0.5 * step), middle);
        let k3 = law.rate(parameters, moved(state, k2, 0.5 * step), middle);
        let k4 = law.rate(parameters, moved(state, k3, step), end);
        let mean = |[a, b, c, d]: [f64; 4]| (a + 2.0 * b + 2.0 * c + d) / 6.0;
        let ([x1, y1, z1], [x2, y2, z2], [x3, y3, z3], [x4, y4, z4]) = (k1, k2, k3, k4);
        let slope = [mean([x1, x2, x3, x4]), mean([y1, y2, y3, y4]), mean([z1, z2, z3, z4])];
        state = law.limited(parameters, moved(state, slope, step));
    }
    state
}

fn moved([x, y, z]: State, [by_x, by_y, by_z]: State, time: f64) -> State {
    [x + time * by_x, y + time * by_y, z + time * by_z]
}
