//! Records in weak form, prepared for any expression: ∫φ̈·θ = Σ wₖ·∫φ·gₖ over windows of one period.

#![allow(clippy::indexing_slicing, reason = "the range is found among the states")]

use super::super::weak_sindy::EXPONENT;
use crate::data::{Trajectory, local_states};
use crate::expression::Expression;
use crate::{LearnError, Place};
use dynamics::Hold;
use dynamics::weak_form::test_function;
use nalgebra::{DMatrix, DVector};

/// States, and the windows that contain them.
pub(super) struct Weak {
    places: Vec<Place>,
    /// First state of each window, and the weights of the states from there on.
    windows: Vec<(usize, Vec<f64>)>,
    /// Integral of the acceleration over each window.
    pub(super) right: DVector<f64>,
}

impl Weak {
    /// Builds windows of one period. They are a quarter of a period apart, or farther if there would
    /// otherwise be more than `most`.
    pub(super) fn new(parts: &[Trajectory], period_s: f64, hold: Hold, most: usize) -> Self {
        let whole: f64 = parts.iter().map(Trajectory::duration_s).sum();
        let step = (whole / most.max(1) as f64).max(0.25 * period_s);
        let half = 0.5 * period_s;
        let (mut places, mut windows, mut right) = (Vec::new(), Vec::new(), Vec::new());
        for part in parts {
            let states = local_states(part, period_s / 8.0);
            let (Some(first), Some(last)) = (states.first(), states.last()) else { continue };
            let count = ((last.time_s - first.time_s - 2.0 * half) / step).floor().max(0.0) as usize;
            let times = part.times_s();
            for number in 0..count {
                let center = first.time_s + half + number as f64 * step;
                let from = states.partition_point(|state| state.time_s < center - half);
                let to = states.partition_point(|state| state.time_s <= center + half);
                let mut sum = 0.0;
                let mut weights = Vec::new();
                for state in &states[from..to] {
                    let [value, _, curvature] = test_function((state.time_s - center) / half, EXPONENT);
                    let time = |at: usize| times.get(at).copied().unwrap_or(state.time_s);
                    let interval = 0.5 * (time(state.sample + 1) - time(state.sample.saturating_sub(1)));
                    let observed = part.values().get(state.sample).copied().unwrap_or(state.position);
                    sum += interval * curvature / (half * half) * observed;
                    weights.push(interval * value);
                }
                windows.push((places.len() + from, weights));
                right.push(sum);
            }
            places.extend(states.iter().map(|state| {
                let before = part.input().and_then(|input| input.get(state.sample.saturating_sub(1)));
                let input = match hold {
                    Hold::Zero => 0.5 * (state.input + before.copied().unwrap_or(state.input)),
                    Hold::Linear | Hold::BandLimited => state.input,
                };
                let direction = state.velocity.signum();
                Place { position: state.position, velocity: state.velocity, direction, input }
            }));
        }
        Self { places, windows, right: DVector::from_vec(right) }
    }

    /// Returns the integral of an expression over each window; `None` if it is not finite.
    pub(super) fn column(&self, part: &Expression) -> Option<DVector<f64>> {
        let values: Vec<f64> = self.places.iter().map(|place| part.dual(place)[0]).collect();
        let of = |(from, weights): &(usize, Vec<f64>)| -> f64 {
            weights.iter().zip(values.iter().skip(*from)).map(|(weight, value)| weight * value).sum()
        };
        let column = DVector::from_iterator(self.windows.len(), self.windows.iter().map(of));
        column.iter().all(|value| value.is_finite()).then_some(column)
    }

    /// Returns the columns of several expressions.
    pub(super) fn columns(&self, parts: &[Expression]) -> Option<DMatrix<f64>> {
        let columns: Option<Vec<DVector<f64>>> = parts.iter().map(|part| self.column(part)).collect();
        columns.map(|columns| DMatrix::from_columns(&columns))
    }

    /// Returns the squared error of a weighted sum for each window, divided by the mean square of the right
    /// side.
    pub(super) fn errors(&self, parts: &[Expression], weights: &[f64]) -> Option<Vec<f64>> {
        let off = self.columns(parts)? * DVector::from_column_slice(weights) - &self.right;
        let size = self.right.norm_squared() / self.right.len().max(1) as f64;
        Some(off.iter().map(|off| off * off / size).collect())
    }

    /// Refuses records without a window.
    pub(super) fn checked(self) -> Result<Self, LearnError> {
        if self.windows.is_empty() {
            let problem =
                "no record is as long as a period and a quarter; set period_s, or give longer records";
            return Err(LearnError::Unsolvable { what: "symbolic", problem: problem.to_owned() });
        }
        Ok(self)
    }
}
