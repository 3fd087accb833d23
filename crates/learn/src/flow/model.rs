//! Model that integrates a field with weights.

use super::field::Field;
use super::run::Run;
use super::start::{State, first_guess};
use crate::data::{DataSet, Trajectory};
use crate::{Ahead, Coefficient, LearnError, Model, Past, Place, Predicted, Stored, Tensor, Torque};
use dynamics::Hold;
use nalgebra::{DMatrix, Matrix2, Vector2};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use seed::Seed;
use serde::{Deserialize, Serialize};

/// Integration settings of a field, and the noise of its predictions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Running {
    /// Longest step in seconds.
    pub longest_step_s: f64,
    /// Typical period in seconds.
    pub period_s: f64,
    /// Interpolation of the input between samples.
    pub hold: Hold,
    /// Absolute position beyond which the motion counts as diverged.
    pub bound: f64,
    /// Standard deviation of a measured position about the prediction.
    pub noise: f64,
}

impl Running {
    /// Takes the integration settings of a data set; `noise` is the root mean square residual.
    #[must_use]
    pub fn new(data: &DataSet, noise: f64) -> Self {
        Self {
            longest_step_s: data.longest_step_s(),
            period_s: data.period_s,
            hold: data.hold,
            bound: data.scale.center.abs() + 1e3 * data.scale.position,
            noise,
        }
    }
}

/// Draws from the posterior of the weights.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Posterior {
    /// Draws, each as long as the weights; empty for a model without a posterior.
    pub draws: Vec<Vec<f64>>,
}

/// Number of draws that a band is computed from.
const DRAWS: usize = 24;

impl Posterior {
    /// Draws as [`Self::normal`] does; empty without a covariance.
    pub(crate) fn of(mean: &[f64], covariance: Option<&DMatrix<f64>>, seed: &Seed) -> Self {
        covariance.map_or_else(Self::default, |covariance| Self::normal(mean, covariance, seed))
    }

    /// Draws from a normal distribution around `mean`; empty if the covariance is not positive definite.
    #[must_use]
    pub fn normal(mean: &[f64], covariance: &DMatrix<f64>, seed: &Seed) -> Self {
        let Some(root) = crate::linear::raised(covariance, 1e-12).cholesky() else { return Self::default() };
        let mut generator = seed.child("posterior").generator();
        let mut draw = || {
            let standard: Vec<f64> = mean.iter().map(|_| StandardNormal.sample(&mut generator)).collect();
            let moved = root.l() * nalgebra::DVector::from_vec(standard);
            mean.iter().zip(moved.iter()).map(|(mean, by)| mean + by).collect()
        };
        Self { draws: (0..DRAWS).map(|_| draw()).collect() }
    }
}

/// Law of motion as a model. The initial state of a prediction is the one that fits the past best.
pub struct FlowModel {
    /// Identifier of the learner.
    pub learner: &'static str,
    /// Law of motion.
    pub field: Box<dyn Field>,
    /// Weights of the law.
    pub weights: Vec<f64>,
    /// Draws of the weights, for bands; empty for a model without bands.
    pub posterior: Posterior,
    /// Integration settings.
    pub running: Running,
    /// Coefficients of the law; empty if it has none.
    pub coefficients: Vec<Coefficient>,
    /// The law as text; `None` if it cannot be written as an equation.
    pub equation: Option<String>,
    /// JSON form from which the field is rebuilt when the model is read from a file.
    pub form: serde_json::Value,
}

/// Contents of a flow's file beside the weights.
#[derive(Serialize, Deserialize)]
struct Described {
    running: Running,
    coefficients: Vec<Coefficient>,
    equation: Option<String>,
    form: serde_json::Value,
}

/// Gauss–Newton steps of a search for an initial state.
const STEPS: usize = 8;

impl FlowModel {
    fn run<'a>(&'a self, weights: &'a [f64]) -> Run<'a> {
        Run {
            field: self.field.as_ref(),
            weights,
            longest_step_s: self.running.longest_step_s,
            hold: self.running.hold,
            bound: self.running.bound,
        }
    }

    /// Fits the state at the past's first sample by Gauss–Newton with finite differences. Returns it with its
    /// covariance per unit variance of a sample.
    fn start(&self, weights: &[f64], past: &Trajectory) -> Result<(State, Matrix2<f64>), LearnError> {
        let run = self.run(weights);
        let motion = |state: State| {
            run.motion(state, past.times_s(), past.input(), false).map(|motion| motion.positions)
        };
        let rss = |positions: &[f64]| -> f64 {
            past.values().iter().zip(positions).map(|(a, b)| (a - b).powi(2)).sum()
        };
        let spread = self.running.bound * 1e-3;
        let (by_x, by_v) = (1e-5 * spread, 1e-5 * spread / self.running.period_s);
        let mut state = first_guess(past, self.running.period_s);
        let mut positions = motion(state)?;
        let mut inverse = Matrix2::zeros();
        for _ in 0..STEPS {
            let moved_x = motion(State { position: state.position + by_x, ..state })?;
            let moved_v = motion(State { velocity: state.velocity + by_v, ..state })?;
            let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
            let rows = past.values().iter().zip(&positions).zip(moved_x.iter().zip(&moved_v));
            for ((observed, predicted), (x, v)) in rows {
                let row = Vector2::new((x - predicted) / by_x, (v - predicted) / by_v);
                normal += row * row.transpose();
                right += row * (observed - predicted);
            }
            let Some(found) = normal.try_inverse() else { break };
            inverse = found;
            let step = inverse * right;
            let (mut share, before) = (1.0, rss(&positions));
            let mut better = None;
            while share > 1e-3 && better.is_none() {
                let next = State {
                    position: state.position + share * step.x,
                    velocity: state.velocity + share * step.y,
                };
                better = motion(next).ok().filter(|found| rss(found) < before).map(|found| (next, found));
                share *= 0.25;
            }
            let Some((next, found)) = better else { break };
            let gained = before - rss(&found);
            (state, positions) = (next, found);
            if gained < 1e-7 * before {
                break;
            }
        }
        Ok((state, inverse))
    }

    fn ahead(&self, weights: &[f64], state: State, all: &Joined) -> Result<Vec<f64>, LearnError> {
        let motion = self.run(weights).motion(state, &all.times_s, all.input.as_deref(), false)?;
        Ok(motion.positions.into_iter().skip(all.past).collect())
    }

    /// Restores a stored model; `field` rebuilds the field from its form.
    ///
    /// # Errors
    /// [`LearnError::Stored`] for a file of another form, or if the number of weights differs from the
    /// field's.
    pub fn restore(
        learner: &'static str,
        stored: &Stored,
        field: impl FnOnce(&serde_json::Value) -> Result<Box<dyn Field>, LearnError>,
    ) -> Result<Self, LearnError> {
        let described: Described = stored.described()?;
        let field = field(&described.form)?;
        let weights = stored.tensor("weights")?.values.clone();
        let draws = &stored.tensor("draws")?.values;
        if weights.len() != field.weights() {
            let problem = format!("{} weights where the law has {}", weights.len(), field.weights());
            return Err(LearnError::Stored { problem });
        }
        let draws = draws.chunks_exact(weights.len().max(1)).map(<[f64]>::to_vec).collect();
        Ok(Self {
            learner,
            field,
            weights,
            posterior: Posterior { draws },
            running: described.running,
            coefficients: described.coefficients,
            equation: described.equation,
            form: described.form,
        })
    }
}

/// Past and future in one sequence of times.
struct Joined {
    times_s: Vec<f64>,
    input: Option<Vec<f64>>,
    past: usize,
}

fn joined(past: &Past<'_>, ahead: &Ahead<'_>) -> Joined {
    let input = past.input.zip(ahead.input).map(|(before, after)| [before, after].concat());
    Joined { times_s: [past.times_s, ahead.times_s].concat(), input, past: past.times_s.len() }
}

fn trajectory(past: &Past<'_>) -> Result<Trajectory, LearnError> {
    Trajectory::new("past", past.times_s.to_vec(), past.values.to_vec(), past.input.map(<[f64]>::to_vec))
}

impl Model for FlowModel {
    fn free_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        let (state, _) = self.start(&self.weights, &trajectory(past)?)?;
        let values = self.ahead(&self.weights, state, &joined(past, ahead))?;
        Ok(Predicted { values, std: None })
    }

    fn banded_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        let (past_part, all) = (trajectory(past)?, joined(past, ahead));
        let (state, _) = self.start(&self.weights, &past_part)?;
        let values = self.ahead(&self.weights, state, &all)?;
        if self.posterior.draws.is_empty() {
            return Ok(Predicted { values, std: None });
        }
        let variance = self.running.noise * self.running.noise;
        let mut squares = vec![0.0; values.len()];
        let mut generator = Seed::new(0).child("start states").generator();
        for draw in &self.posterior.draws {
            // A diverging draw shows only that the band is wide; it counts at the bound.
            let run = self.start(draw, &past_part).and_then(|(state, inverse)| {
                self.ahead(draw, scattered(state, &(inverse * variance), &mut generator), &all)
            });
            let drawn = run.unwrap_or_else(|_| vec![self.running.bound; values.len()]);
            for ((square, drawn), value) in squares.iter_mut().zip(drawn).zip(&values) {
                *square += (drawn - value).powi(2);
            }
        }
        let count = self.posterior.draws.len() as f64;
        let std = squares.iter().map(|square| (square / count + variance).sqrt()).collect();
        Ok(Predicted { values, std: Some(std) })
    }

    fn parameters(&self) -> usize {
        self.weights.len()
    }

    fn coefficients(&self) -> &[Coefficient] {
        &self.coefficients
    }

    fn torque(&self, place: &Place) -> Option<Torque> {
        let value = self.field.acceleration(&self.weights, place);
        let draws = &self.posterior.draws;
        let square = |draw: &Vec<f64>| (self.field.acceleration(draw, place) - value).powi(2);
        let std =
            (!draws.is_empty()).then(|| (draws.iter().map(square).sum::<f64>() / draws.len() as f64).sqrt());
        Some(Torque { value, std })
    }

    fn equation(&self) -> Option<String> {
        self.equation.clone()
    }

    fn stored(&self) -> Option<Stored> {
        if self.form.is_null() {
            return None;
        }
        let described = Described {
            running: self.running,
            coefficients: self.coefficients.clone(),
            equation: self.equation.clone(),
            form: self.form.clone(),
        };
        let (count, draws) = (self.weights.len(), &self.posterior.draws);
        let tensors = vec![
            Tensor { name: "draws".to_owned(), shape: vec![draws.len(), count], values: draws.concat() },
            Tensor { name: "weights".to_owned(), shape: vec![count], values: self.weights.clone() },
        ];
        Stored::new(self.learner, &described, tensors).ok()
    }
}

/// Draws a state from a normal distribution.
fn scattered(state: State, covariance: &Matrix2<f64>, generator: &mut impl Rng) -> State {
    let by = Vector2::new(StandardNormal.sample(generator), StandardNormal.sample(generator));
    match covariance.cholesky() {
        Some(root) => {
            let moved: Vector2<f64> = root.l() * by;
            State { position: state.position + moved.x, velocity: state.velocity + moved.y }
        }
        None => state,
    }
}
