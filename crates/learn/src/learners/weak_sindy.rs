//! Sparse identification in weak form.
//!
//! Both sides of θ̈ = Σ wᵢ·fᵢ are integrated against test functions that vanish, with their derivatives, at
//! the ends of a window. Integration by parts moves the derivatives to the test functions: ∫φ̈·θ = Σ
//! wᵢ·∫φ·fᵢ, ∫φ·θ̇ = −∫φ̇·θ. No observation is differentiated; a velocity is estimated by local polynomials
//! only for terms that are not linear in it.
//!
//! Messenger, Bortz, Multiscale Modeling and Simulation 19 (2021) 1474.

#![allow(clippy::indexing_slicing, reason = "the range is found among the states")]

use super::library::{Regression, Term, restore};
use super::sindy::{FIELDS, SparseSettings};
use crate::data::{DataSet, LocalState, Trajectory, local_states};
use crate::{Context, Entry, Fitted, Kind, LearnError, Learner, Place};
use dynamics::weak_form::test_function;
use nalgebra::{DMatrix, DVector};

/// Identifier.
const ID: &str = "weak-sindy";

/// Entry in the registry.
pub const ENTRY: Entry = Entry {
    id: ID,
    title: "Weak-form sparse identification",
    summary: "As SINDy, with a regression in weak form, in which no observation is differentiated.",
    reference: "Messenger, Bortz, Multiscale Modeling and Simulation 19 (2021) 1474",
    kind: Kind::Regressor,
    fields: FIELDS,
    build: |resolved| {
        Ok(Box::new(WeakSindy { settings: SparseSettings::read(resolved, ID)? }) as Box<dyn Learner>)
    },
    restore: |stored| restore(ID, stored),
};

/// The learner.
#[derive(Debug, Clone, PartialEq)]
pub struct WeakSindy {
    /// Settings.
    pub settings: SparseSettings,
}

impl Learner for WeakSindy {
    fn fit(&self, data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError> {
        let regression = regression(data, &self.settings.terms(data));
        self.settings.learn(ID, &regression, data, context)
    }
}

/// Largest number of windows of a regression.
const MOST_WINDOWS: usize = 16_000;

/// Exponent of the test functions (1 − s²)⁴: smooth enough that sums over samples approximate integrals.
pub(super) const EXPONENT: i32 = 4;

/// Builds the regression in weak form: one row per window of one period, with windows at least an eighth of a
/// period apart; groups are periods.
pub(crate) fn regression(data: &DataSet, terms: &[Term]) -> Regression {
    let whole: f64 = data.train.iter().map(Trajectory::duration_s).sum();
    let step = (whole / MOST_WINDOWS as f64).max(data.period_s / 8.0);
    let half = 0.5 * data.period_s;
    let (mut rows, mut right, mut groups, mut group) = (Vec::new(), Vec::new(), Vec::new(), 0);
    for part in &data.train {
        let states = local_states(part, data.period_s / 8.0);
        let (Some(first), Some(last)) = (states.first(), states.last()) else { continue };
        let count = ((last.time_s - first.time_s - 2.0 * half) / step).floor().max(0.0) as usize;
        for window in 0..count {
            let center = first.time_s + half + window as f64 * step;
            let from = states.partition_point(|state| state.time_s < center - half);
            let to = states.partition_point(|state| state.time_s <= center + half);
            let (row, sum) = weak_row(part, &states[from..to], center, half, terms);
            rows.extend(row);
            right.push(sum);
            groups.push(group + window / 8);
        }
        group += count / 8 + 1;
    }
    Regression {
        rows: DMatrix::from_row_slice(right.len(), terms.len(), &rows),
        right: DVector::from_vec(right),
        terms: terms.to_vec(),
        groups,
    }
}

/// Returns the integrals of the terms and of the acceleration over one window, by the trapezoidal rule on the
/// samples.
fn weak_row(
    part: &Trajectory,
    inside: &[LocalState],
    center: f64,
    half: f64,
    terms: &[Term],
) -> (Vec<f64>, f64) {
    let (mut row, mut sum) = (vec![0.0; terms.len()], 0.0);
    let times = part.times_s();
    for state in inside {
        let s = (state.time_s - center) / half;
        let [value, slope, curvature] = test_function(s, EXPONENT);
        let (slope, curvature) = (slope / half, curvature / (half * half));
        let time = |at: usize| times.get(at).copied().unwrap_or(state.time_s);
        let weight = 0.5 * (time(state.sample + 1) - time(state.sample.saturating_sub(1)));
        let observed = part.values().get(state.sample).copied().unwrap_or(state.position);
        sum += weight * curvature * observed;
        let place = Place {
            position: observed,
            velocity: state.velocity,
            direction: state.velocity.signum(),
            input: state.input,
        };
        for (own, term) in row.iter_mut().zip(terms) {
            *own += weight
                * match term {
                    Term::Velocity => -slope * observed,
                    other => value * other.value(&place),
                };
        }
    }
    (row, sum)
}
