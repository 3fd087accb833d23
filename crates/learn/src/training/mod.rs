//! Training loop shared by the sequence models: batches of windows, Adam, a learning-rate schedule, gradient
//! clipping, early stopping, and a state that resumes bit for bit.
//!
//! A sequence model implements [`Trainable`]: its initial weights, the loss of a batch with its gradient, and
//! a validation error. [`train`] does the rest. Kingma, Ba, ICLR 2015 (Adam); Loshchilov, Hutter, ICLR 2017
//! and 2019 (cosine schedule, decoupled weight decay); Pascanu, Mikolov, Bengio, ICML 2013 (clipping).

mod schedule;
#[cfg(test)]
mod tests;

pub use schedule::Schedule;

use crate::data::Window;
use crate::{Context, LearnError, Step};
use rand::seq::SliceRandom;
use seed::Seed;
use serde::{Deserialize, Serialize};

/// Model with a loss that can be minimized.
pub trait Trainable {
    /// Draws initial weights from a seed.
    ///
    /// # Errors
    /// [`LearnError`] if they cannot be drawn.
    fn initial(&self, seed: &Seed) -> Result<Vec<f64>, LearnError>;

    /// Returns the mean loss of a batch of windows and writes its gradient into `gradient`, which is as long
    /// as the weights and zero on entry.
    ///
    /// # Errors
    /// [`LearnError`] if the batch cannot be computed.
    fn loss(&self, weights: &[f64], batch: &[Window], gradient: &mut [f64]) -> Result<f64, LearnError>;

    /// Returns the error on the validation part, which decides when to stop and which weights to keep.
    ///
    /// # Errors
    /// [`LearnError`] if it cannot be computed.
    fn validation(&self, weights: &[f64]) -> Result<f64, LearnError>;

    /// Returns the factor that converts the square root of the loss to the unit of the positions.
    fn unit(&self) -> f64 {
        1.0
    }
}

/// Options of a training.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Training {
    /// Number of passes over the windows.
    pub epochs: u64,
    /// Number of windows in a batch.
    pub batch: usize,
    /// Learning-rate schedule.
    pub schedule: Schedule,
    /// Norm to which a gradient is clipped.
    pub clip: f64,
    /// Weight decay per step, divided by the learning rate.
    pub weight_decay: f64,
    /// Number of epochs without a better validation error after which training stops.
    pub patience: u64,
}

/// State of a training: everything needed to resume it bit for bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Current weights.
    pub weights: Vec<f64>,
    /// Weights with the smallest validation error so far.
    pub best: Vec<f64>,
    /// Validation error of `best`.
    pub best_validation: f64,
    /// Number of epochs since `best` was found.
    pub waited: u64,
    /// Number of completed epochs.
    pub epoch: u64,
    /// Number of completed steps.
    pub steps: u64,
    first: Vec<f64>,
    second: Vec<f64>,
}

/// Finished training.
#[derive(Debug, Clone, PartialEq)]
pub struct Trained {
    /// Final state; `best` holds the weights to use.
    pub state: State,
    /// `true` if the validation error stopped improving before the epochs ran out.
    pub stopped_early: bool,
}

/// Decay of Adam's averages of the gradient and of its square.
const DECAYS: [f64; 2] = [0.9, 0.999];

/// Term that keeps Adam's denominator from vanishing.
const SMALL: f64 = 1e-8;

/// Trains on windows, from the beginning or from a stored state. `keep` is called after every epoch; if the
/// training is interrupted, it is called with the state before the interrupted epoch.
///
/// The order of the windows in an epoch depends only on the seed and the number of the epoch, so a resumed
/// training sees the same batches as an uninterrupted one.
///
/// # Errors
/// [`LearnError::Interrupted`], and the model's errors; [`LearnError::Unsolvable`] if there is no window.
pub fn train(
    model: &dyn Trainable,
    windows: &[Window],
    training: &Training,
    from: Option<State>,
    context: &Context<'_>,
    keep: &mut dyn FnMut(&State) -> Result<(), LearnError>,
) -> Result<Trained, LearnError> {
    if windows.is_empty() {
        let problem =
            "no training record is as long as a past and a future together; shorten them".to_owned();
        return Err(LearnError::Unsolvable { what: "training", problem });
    }
    let mut state = match from {
        Some(state) => state,
        None => State::new(model, context)?,
    };
    let of_epoch = windows.len().div_ceil(training.batch.max(1)) as u64;
    let budget = context.steps(training.epochs * of_epoch);
    while state.steps < budget && state.waited < training.patience {
        let before = state.clone();
        let loss = match state.epoch(model, windows, training, (of_epoch, budget), context) {
            Err(LearnError::Interrupted) => {
                keep(&before)?;
                return Err(LearnError::Interrupted);
            }
            loss => loss?,
        };
        let validation = model.validation(&state.weights)?;
        state.judge(validation);
        let phase = format!("epoch {}", state.epoch);
        (context.observe)(&Step {
            step: state.steps,
            phase,
            train: loss.sqrt() * model.unit(),
            validation: Some(validation),
        });
        keep(&state)?;
    }
    let stopped_early = state.waited >= training.patience;
    Ok(Trained { state, stopped_early })
}

impl State {
    fn new(model: &dyn Trainable, context: &Context<'_>) -> Result<Self, LearnError> {
        let weights = model.initial(&context.seed.child("initial weights"))?;
        let best_validation = model.validation(&weights)?;
        let zeros = vec![0.0; weights.len()];
        let best = weights.clone();
        Ok(Self {
            best_validation,
            best,
            waited: 0,
            epoch: 0,
            steps: 0,
            first: zeros.clone(),
            second: zeros,
            weights,
        })
    }

    /// Makes one pass over the windows and returns the mean loss.
    fn epoch(
        &mut self,
        model: &dyn Trainable,
        windows: &[Window],
        training: &Training,
        (of_epoch, budget): (u64, u64),
        context: &Context<'_>,
    ) -> Result<f64, LearnError> {
        let mut order = windows.to_vec();
        let seed = context.seed.child("batches").child(&self.epoch.to_string());
        order.shuffle(&mut seed.generator());
        let (mut sum, mut count) = (0.0, 0_usize);
        for batch in order.chunks(training.batch.max(1)) {
            if self.steps >= budget {
                break;
            }
            context.check()?;
            let mut gradient = vec![0.0; self.weights.len()];
            sum += model.loss(&self.weights, batch, &mut gradient)?;
            count += 1;
            let rate = training.schedule.rate(self.steps, training.epochs * of_epoch);
            self.step(&mut gradient, rate, training);
        }
        self.epoch += 1;
        Ok(sum / count.max(1) as f64)
    }

    /// Takes one step of Adam with decoupled weight decay.
    fn step(&mut self, gradient: &mut [f64], rate: f64, training: &Training) {
        let norm = gradient.iter().map(|own| own * own).sum::<f64>().sqrt();
        if !norm.is_finite() {
            // A batch with a non-finite gradient is skipped; the step still counts, so that the schedule
            // continues.
            self.steps += 1;
            return;
        }
        let cut = (training.clip / norm.max(f64::MIN_POSITIVE)).min(1.0);
        self.steps += 1;
        let [of_first, of_second] = DECAYS;
        let power = i32::try_from(self.steps).unwrap_or(i32::MAX);
        let (unbias, unbias_square) = (1.0 - of_first.powi(power), 1.0 - of_second.powi(power));
        let moments = self.first.iter_mut().zip(&mut self.second);
        for ((weight, own), (first, second)) in self.weights.iter_mut().zip(gradient).zip(moments) {
            let own = *own * cut;
            *first = of_first * *first + (1.0 - of_first) * own;
            *second = of_second * *second + (1.0 - of_second) * own * own;
            let direction = (*first / unbias) / ((*second / unbias_square).sqrt() + SMALL);
            *weight -= rate * (direction + training.weight_decay * *weight);
        }
    }

    fn judge(&mut self, validation: f64) {
        if validation < self.best_validation {
            self.best_validation = validation;
            self.best.clone_from(&self.weights);
            self.waited = 0;
        } else {
            self.waited += 1;
        }
    }
}
