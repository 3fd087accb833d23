//! Linear autoregression with exogenous input (ARX), run freely: the baseline of linear system
//! identification.
//!
//! yₖ = c + Σ aᵢ·yₖ₋ᵢ + Σ bᵢ·uₖ₋ᵢ by least squares of the one-step error (Ljung, System Identification, 2nd
//! ed. 1999, section 4.2). The order is the one whose free run has the smallest validation error.

use crate::data::{DataSet, LEAST_PAST, span_s};
use crate::judge::validation_error;
use crate::linear::least_squares;
use crate::{Ahead, LearnError, Model, Past, Predicted};
use nalgebra::{DMatrix, DVector};

/// Linear autoregression with exogenous input.
#[derive(Debug, Clone, PartialEq)]
pub struct Arx {
    /// Weight of each earlier position, latest first.
    positions: Vec<f64>,
    /// Weight of each earlier input, latest first; empty without an input.
    inputs: Vec<f64>,
    constant: f64,
    bound: f64,
}

/// Candidate orders.
const ORDERS: [usize; 6] = [2, 4, 8, 16, 24, 32];

/// Largest number of rows of a regression.
const MOST_ROWS: usize = 8_000;

impl Arx {
    /// Fits every order that the warm-up has enough samples for, and keeps the one with the smallest
    /// validation error.
    ///
    /// # Errors
    /// [`LearnError::Unsolvable`] if no order can be fitted.
    pub fn fit(data: &DataSet) -> Result<Self, LearnError> {
        Self::validated(data, &[0.0])
    }

    /// Fits every order with every ridge and keeps the pair whose free run has the smallest validation error.
    ///
    /// A ridge is a share of each regressor's mean square. It keeps the weights of a smooth input from
    /// growing large and canceling each other.
    ///
    /// # Errors
    /// As [`Self::fit`].
    pub(crate) fn validated(data: &DataSet, ridges: &[f64]) -> Result<Self, LearnError> {
        let shortest = data.train.iter().map(|part| part.samples_within(data.warm_up_s)).min();
        let most = shortest.map_or(LEAST_PAST, |shortest| shortest.max(LEAST_PAST));
        let orders = ORDERS.iter().filter(|order| **order < most);
        let fitted = orders
            .flat_map(|&order| ridges.iter().map(move |&ridge| (order, ridge)))
            .filter_map(|(order, ridge)| of(data, order, ridge));
        let scored = fitted.map(|model| (validation_error(&model, data), model));
        let best = scored.min_by(|a, b| a.0.total_cmp(&b.0));
        best.map(|(_, model)| model).ok_or(LearnError::Unsolvable {
            what: "arx",
            problem: "no order could be fitted; give longer training records".to_owned(),
        })
    }
}

impl Arx {
    /// Returns the same model without a bound on its predictions.
    pub(crate) fn unbounded(self) -> Self {
        Self { bound: f64::INFINITY, ..self }
    }
}

fn of(data: &DataSet, order: usize, ridge: f64) -> Option<Arx> {
    let driven = data.is_driven();
    let width = order * (1 + usize::from(driven)) + 1;
    let stride = (data.training_samples() / MOST_ROWS).max(1);
    let (mut rows, mut right) = (Vec::new(), Vec::new());
    for part in &data.train {
        for now in (order..part.len()).step_by(stride) {
            rows.extend(latest_first(part.values(), now, order));
            rows.extend(part.input().into_iter().flat_map(|input| latest_first(input, now, order)));
            rows.push(1.0);
            right.push(part.values().get(now).copied()?);
        }
    }
    let count = right.len();
    let mut rows = DMatrix::from_row_slice(count, width, &rows);
    if ridge > 0.0 {
        let sizes = rows.column_iter().map(|column| ridge.sqrt() * column.norm());
        let below = DMatrix::from_diagonal(&DVector::from_iterator(width, sizes));
        rows = rows.resize_vertically(count + width, 0.0);
        rows.rows_mut(count, width).copy_from(&below);
        right.resize(count + width, 0.0);
    }
    let weights = least_squares(&rows, &DVector::from_vec(right))?;
    let (positions, rest) = weights.as_slice().split_at_checked(order)?;
    let (constant, inputs) = rest.split_last()?;
    let bound = data.scale.center.abs() + 1e3 * data.scale.position;
    Some(Arx { positions: positions.to_vec(), inputs: inputs.to_vec(), constant: *constant, bound })
}

/// Returns the `count` values before `now`, latest first.
fn latest_first(values: &[f64], now: usize, count: usize) -> impl Iterator<Item = f64> + '_ {
    values.split_at(now.min(values.len())).0.iter().rev().take(count).copied()
}

impl Model for Arx {
    fn free_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        let order = self.positions.len();
        let known = past.values.len();
        let Some(first) = past.times_s.first().filter(|_| known >= order) else {
            let spacing = span_s(past.times_s) / known.saturating_sub(1).max(1) as f64;
            let needed_s = spacing * (order as f64 - 1.0);
            return Err(LearnError::ShortPast { samples: known, needed: order, needed_s });
        };
        let mut values = past.values.to_vec();
        let inputs: Vec<f64> = past.input.into_iter().chain(ahead.input).flatten().copied().collect();
        for (number, time) in ahead.times_s.iter().enumerate() {
            let now = known + number;
            let sum = |weights: &[f64], from: &[f64]| -> f64 {
                weights.iter().zip(latest_first(from, now, order)).map(|(weight, value)| weight * value).sum()
            };
            let value = self.constant + sum(&self.positions, &values) + sum(&self.inputs, &inputs);
            if value.is_nan() || value.abs() > self.bound {
                return Err(LearnError::Diverged { time_s: time - first, bound: self.bound });
            }
            values.push(value);
        }
        Ok(Predicted { values: values.split_off(known), std: None })
    }

    fn parameters(&self) -> usize {
        self.positions.len() + self.inputs.len() + 1
    }
}
