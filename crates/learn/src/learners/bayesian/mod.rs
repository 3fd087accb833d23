//! Posterior of the coefficients of a stated law, by the no-U-turn sampler.
//!
//! The law is a sum of stated terms. The likelihood is that of whole trajectories with Gaussian noise.
//! Initial states are profiled out: each takes one Gauss–Newton step, whose derivative vanishes at the
//! optimum. The noise is that of the best fit, inflated for correlated residuals. The prior of the
//! coefficients is flat. Gradients come from exact sensitivities; the sampler works in coordinates in which
//! Laplace's approximation is a standard normal distribution.

#[cfg(test)]
#[allow(clippy::print_stdout, reason = "what it finds is read, not only checked")]
mod coverage;
mod nuts;

use super::library::{LAW, Library, Regression, law, restore, thresholded};
use super::sindy::SparseSettings;
use super::torque::{Progress, progressive};
use super::weak_sindy;
use crate::data::{DataSet, Trajectory};
use crate::flow::{FieldShooter, Fit, Penalty, Posterior, Running, Shooter, State};
use crate::judge::validation_error;
use crate::{Context, Entry, Fitted, Kind, LearnError, Learner};
use estimator::Reached;
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use serde::Deserialize;
use settings::{Default, Field, Kind as Value, Resolved, SettingsError};

/// Identifier.
const ID: &str = "bayesian";

/// Entry in the registry.
pub const ENTRY: Entry = Entry {
    id: ID,
    title: "Bayesian coefficients (NUTS)",
    summary: "Samples the posterior of the coefficients of a stated law from whole trajectories.",
    reference: "Hoffman, Gelman, Journal of Machine Learning Research 15 (2014) 1593-1623",
    kind: Kind::Regressor,
    fields: FIELDS,
    build: |resolved| Ok(Box::new(Bayesian::read(resolved)?) as Box<dyn Learner>),
    restore: |stored| restore(ID, stored),
};

const FIELDS: &[Field] = &[
    LAW,
    Field::new("warm_up", Value::Integer { min: 1, max: 1_000_000 }, Default::Integer(60))
        .unit("draws")
        .meaning("Draws in which the step is adapted; none is kept."),
    Field::new("draws", Value::Integer { min: 10, max: 1_000_000 }, Default::Integer(240))
        .unit("draws")
        .meaning("Draws that are kept."),
    Field::new("samples", Value::Integer { min: 100, max: 10_000_000 }, Default::Integer(3_000))
        .unit("samples")
        .meaning("Most training samples; if there are more, evenly spaced pieces are used."),
    Field::new("max_steps", Value::Integer { min: 0, max: 1_000_000 }, Default::Integer(40))
        .unit("steps")
        .meaning("Most steps of the fit that the sampler begins at, on pieces of each length."),
];

/// The learner. Ranges and defaults are stated in the registry's fields.
#[derive(Debug, Clone, PartialEq)]
pub struct Bayesian {
    library: SparseSettings,
    keys: Keys,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
struct Keys {
    library: Vec<String>,
    warm_up: usize,
    draws: usize,
    samples: usize,
    max_steps: u64,
}

impl Bayesian {
    fn read(resolved: &Resolved) -> Result<Self, SettingsError> {
        let keys: Keys = resolved.section(ID)?;
        Ok(Self { library: SparseSettings::of_terms(resolved, ID, keys.library.clone())?, keys })
    }
}

impl Learner for Bayesian {
    fn fit(&self, data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError> {
        let terms = self.library.terms(data);
        let library = Library::new(terms.clone());
        let regression: Regression = weak_sindy::regression(data, &terms);
        let start = thresholded(&regression, 0.0);
        let flat = Penalty { mean: vec![0.0; terms.len()], precision: vec![0.0; terms.len()] };
        let plain = |weights: &[f64]| {
            law(ID, &library, (weights, None), Posterior::default(), Running::new(data, data.noise), data)
        };
        let validate = |weights: &[f64]| validation_error(&plain(weights), data);
        let progress = Progress { samples: self.keys.samples, most_steps: self.keys.max_steps };
        let (fit, steps) = progressive(&library, data, context, (&flat, progress), start, &validate)?;
        let (draws, sampled) = self.sampled(&library, data, context, &fit)?;
        let (mean, spread) = moments(&draws, terms.len());
        let kept =
            draws.iter().step_by((draws.len() / BAND).max(1)).map(|draw| draw.as_slice().to_vec()).collect();
        let posterior = Posterior { draws: kept };
        let running = Running::new(data, fit.rms());
        let whole = law(ID, &library, (&mean, Some(&spread)), posterior, running, data);
        Ok(Fitted { model: Box::new(whole), reached: Reached::Converged, steps: steps + sampled })
    }
}

/// Number of draws that bands are computed from.
const BAND: usize = 24;

impl Bayesian {
    fn sampled(
        &self,
        library: &Library,
        data: &DataSet,
        context: &Context<'_>,
        fit: &Fit,
    ) -> Result<(Vec<DVector<f64>>, u64), LearnError> {
        let undetermined = || LearnError::Unsolvable {
            what: ID,
            problem: "the records leave some combination of the terms open; take one out of bayesian.library"
                .to_owned(),
        };
        let root = fit.covariance().and_then(DMatrix::cholesky).ok_or_else(undetermined)?.l();
        let center = DVector::from_column_slice(&fit.weights);
        // As many pieces as the fit had initial states, cut in the same way.
        let pieces = pieces_of(data, self.keys.samples, fit);
        let profile = Profile {
            shooter: FieldShooter::new(library, data),
            pieces: &pieces,
            starts: &fit.starts,
            variance: fit.variance(),
        };
        let target = |place: &DVector<f64>| {
            if context.cancel.is_requested() {
                return None;
            }
            let (log_density, gradient) = profile.at((&center + &root * place).as_slice())?;
            Some((log_density, root.tr_mul(&gradient)))
        };
        let mut generator = context.seed.child("sampler").generator();
        let counts = (self.keys.warm_up, self.keys.draws);
        let draws = nuts::sample(&target, center.len(), counts, &mut generator);
        context.check()?;
        let draws = draws.ok_or_else(undetermined)?;
        let steps = (counts.0 + counts.1) as u64;
        Ok((draws.iter().map(|place| &center + &root * place).collect(), steps))
    }
}

/// Returns the pieces that a fit's initial states belong to; empty if the fit used other pieces.
fn pieces_of(data: &DataSet, samples: usize, fit: &Fit) -> Vec<Trajectory> {
    let lengths = [2.0, 8.0, 1e6];
    let cut = |periods: f64| data.training_pieces(periods * data.period_s, samples);
    let matching = |pieces: &Vec<Trajectory>| {
        pieces.len() == fit.starts.len() && pieces.iter().map(Trajectory::len).sum::<usize>() == fit.samples
    };
    lengths.into_iter().map(cut).find(matching).unwrap_or_default()
}

/// Profile likelihood of the weights: every initial state takes its best value.
struct Profile<'a> {
    shooter: FieldShooter<'a>,
    pieces: &'a [Trajectory],
    starts: &'a [State],
    variance: f64,
}

impl Profile<'_> {
    /// Returns the log likelihood and its gradient; `None` if the motion diverges.
    fn at(&self, weights: &[f64]) -> Option<(f64, DVector<f64>)> {
        let count = weights.len();
        let (mut rss, mut pull) = (0.0, DVector::zeros(count));
        for (piece, start) in self.pieces.iter().zip(self.starts) {
            let mut state = *start;
            // One Gauss–Newton step brings the initial state to its optimum, up to the change that a second
            // step would make.
            for last in [false, true] {
                let shot = self.shooter.shoot(weights, state, piece).ok()?;
                let rows = shot.residuals.iter().zip(shot.jacobian.chunks(count + 2));
                if last {
                    for (residual, row) in rows {
                        rss += residual * residual;
                        for (slot, own) in pull.iter_mut().zip(row) {
                            *slot += residual * own;
                        }
                    }
                } else {
                    let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
                    for (residual, row) in rows {
                        let own: Vector2<f64> = Vector2::from_iterator(row.iter().skip(count).copied());
                        normal += own * own.transpose();
                        right += own * *residual;
                    }
                    let by = normal.try_inverse()? * right;
                    state = State { position: state.position + by.x, velocity: state.velocity + by.y };
                }
            }
        }
        Some((-0.5 * rss / self.variance, pull / self.variance))
    }
}

fn moments(draws: &[DVector<f64>], count: usize) -> (Vec<f64>, Vec<f64>) {
    let number = draws.len().max(1) as f64;
    let mean = draws.iter().fold(DVector::zeros(count), |sum, draw| sum + draw) / number;
    let square = draws.iter().fold(DVector::zeros(count), |sum, draw| {
        let away = draw - &mean;
        sum + away.component_mul(&away)
    }) / number;
    (mean.as_slice().to_vec(), square.map(f64::sqrt).as_slice().to_vec())
}
