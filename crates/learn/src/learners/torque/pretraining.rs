//! First guess of a field's weights without integration: accelerations matched at states estimated from the
//! records.

use crate::Place;
use crate::data::{DataSet, LocalState, Trajectory, local_states};
use crate::flow::{Field, Penalty, Slope};
use crate::linear::{raised, solve};
use dynamics::Hold;
use least_squares::{Descent, Method};
use nalgebra::{DMatrix, DVector};

/// Largest number of states that are matched.
const MOST_STATES: usize = 1_500;

/// First guess of the error of an acceleration estimated from noisy positions, relative to the spread of the
/// accelerations.
const ERROR: f64 = 0.05;

/// Lower limit of that error, relative to the same spread.
const LEAST: f64 = 1e-3;

/// Fits weights to accelerations by Levenberg–Marquardt. Returns them with their root mean square error,
/// relative to the spread of the accelerations.
///
/// The prior is weighted with the error that a first round leaves. Gradient matching: Varah, SIAM Journal on
/// Scientific and Statistical Computing 3 (1982) 28.
pub fn pretrained(
    field: &dyn Field,
    data: &DataSet,
    penalty: &Penalty,
    start: Vec<f64>,
    steps: u64,
) -> (Vec<f64>, f64) {
    let states: Vec<(Place, f64)> = data.train.iter().flat_map(|part| matched(part, data)).collect();
    let stride = states.len().div_ceil(MOST_STATES).max(1);
    let chosen: Vec<(Place, f64)> = states.into_iter().step_by(stride).collect();
    let scale = data.scale.acceleration;
    let (mut weights, mut error) = (start, ERROR);
    for _ in 0..2 {
        let problem = Matching { field, chosen: &chosen, penalty, error: error * scale };
        weights = problem.solved(weights, steps);
        error = (problem.rms(&weights) / scale).max(LEAST);
    }
    (weights, error)
}

/// Returns the states of a part with their accelerations. A held input jumps at each sample; the mean of the
/// values before and after the jump is used.
fn matched(part: &Trajectory, data: &DataSet) -> Vec<(Place, f64)> {
    let of_state = |state: LocalState| {
        let before = part.input().and_then(|input| input.get(state.sample.saturating_sub(1))).copied();
        let input = match data.hold {
            Hold::Zero => 0.5 * (state.input + before.unwrap_or(state.input)),
            Hold::Linear | Hold::BandLimited => state.input,
        };
        let direction = state.velocity.signum();
        (Place { position: state.position, velocity: state.velocity, direction, input }, state.acceleration)
    };
    local_states(part, data.period_s / 8.0).into_iter().map(of_state).collect()
}

/// Method of a round.
const METHOD: Method = Method { least: 1e-12, tolerance: 1e-7, ..Method::TENFOLD };

/// Weights, with their objective and its normal equations.
struct Point {
    weights: Vec<f64>,
    objective: f64,
    normal: DMatrix<f64>,
    right: DVector<f64>,
}

struct Matching<'a> {
    field: &'a dyn Field,
    chosen: &'a [(Place, f64)],
    penalty: &'a Penalty,
    error: f64,
}

impl Matching<'_> {
    /// Returns the weights after Levenberg–Marquardt.
    fn solved(&self, start: Vec<f64>, max_steps: u64) -> Vec<f64> {
        let mut best = self.at(start);
        let mut descent = Descent::new(Method { max_steps, ..METHOD });
        while let Ok(damping) = descent.next_damping() {
            let Some(change) = solve(&raised(&best.normal, damping), &best.right) else { break };
            let next = best.weights.iter().zip(change.iter()).map(|(old, by)| old + by).collect();
            descent.advance(&mut best, Some(self.at(next)), |point| point.objective);
        }
        best.weights
    }

    /// Returns the root mean square error of the accelerations.
    fn rms(&self, weights: &[f64]) -> f64 {
        let off = |(place, wanted): &(Place, f64)| (wanted - self.field.acceleration(weights, place)).powi(2);
        (self.chosen.iter().map(off).sum::<f64>() / self.chosen.len().max(1) as f64).sqrt()
    }

    fn at(&self, weights: Vec<f64>) -> Point {
        let count = weights.len();
        let mut slope = Slope { weights: vec![0.0; count], ..Slope::default() };
        let (mut rows, mut residuals) = (Vec::new(), Vec::new());
        for (place, wanted) in self.chosen {
            let value = self.field.sloped(&weights, place, &mut slope);
            residuals.push((wanted - value) / self.error);
            rows.extend(slope.weights.iter().map(|own| own / self.error));
        }
        let rows = DMatrix::from_row_slice(residuals.len(), count, &rows);
        let residuals = DVector::from_vec(residuals);
        let precision = DVector::from_column_slice(&self.penalty.precision);
        let away = DVector::from_column_slice(&weights) - DVector::from_column_slice(&self.penalty.mean);
        let objective = residuals.norm_squared() + away.dot(&precision.component_mul(&away));
        let normal = rows.tr_mul(&rows) + DMatrix::from_diagonal(&precision);
        let right = rows.tr_mul(&residuals) - precision.component_mul(&away);
        Point { weights, objective, normal, right }
    }
}
