//! Learners: registry entry, settings, and fit.

use crate::data::DataSet;
use crate::{LearnError, Model, Stored};
use estimator::{Cancel, Checkpoints, FitContext, Reached, Silent};
use seed::Seed;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use settings::{Field, Resolved, SettingsError};

/// Kind of learned model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Torque as a function of the state: the model is a differential equation.
    Field,
    /// Map from a window of the past, and the input, to the future.
    Sequence,
    /// Coefficients of a stated law.
    Regressor,
}

impl Kind {
    /// Returns the name for tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Field => "field",
            Self::Sequence => "sequence",
            Self::Regressor => "regressor",
        }
    }
}

/// One step of a training, for trace and progress.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Number of steps so far.
    pub step: u64,
    /// Phase of the training, such as `whole records`.
    pub phase: String,
    /// Root mean square residual of the training part, in the unit of the positions.
    pub train: f64,
    /// Free-run error on the validation part, in the unit of the positions; `None` if it was not computed.
    pub validation: Option<f64>,
}

/// Everything a learner gets besides the data.
pub struct Context<'a> {
    /// Root seed of the learner's random draws.
    pub seed: Seed,
    /// Upper limit on the training steps; `None` leaves the limit to the learner's settings.
    pub max_steps: Option<u64>,
    /// Request to stop.
    pub cancel: &'a Cancel,
    /// Called after every step.
    pub observe: &'a dyn Fn(&Step),
    /// Storage for the state of a training; `None` stores nothing.
    pub checkpoints: Option<&'a dyn Checkpoints>,
}

impl Context<'_> {
    /// Returns an error if a stop was requested.
    ///
    /// # Errors
    /// [`LearnError::Interrupted`].
    pub fn check(&self) -> Result<(), LearnError> {
        if self.cancel.is_requested() { Err(LearnError::Interrupted) } else { Ok(()) }
    }

    /// Returns the stored state to resume from; `None` if none was stored.
    ///
    /// # Errors
    /// [`LearnError::Backend`] if the stored state is not of this type.
    pub fn resumed<T: DeserializeOwned>(&self) -> Result<Option<T>, LearnError> {
        Ok(self.kept().resumed()?)
    }

    /// Stores a state if a checkpoint is due, or if the training is about to stop on request.
    ///
    /// # Errors
    /// [`LearnError::Backend`] if the state cannot be stored.
    pub fn checkpoint<T: Serialize>(&self, step: u64, state: &T) -> Result<(), LearnError> {
        Ok(self.kept().checkpoint(step, || state)?)
    }

    fn kept(&self) -> FitContext<'_> {
        let context = FitContext::new(self.seed.clone(), self.max_steps, &Silent, self.cancel);
        match self.checkpoints {
            Some(place) => context.checkpointing_to(place),
            None => context,
        }
    }

    /// Limits a learner's own number of steps to `max_steps`.
    #[must_use]
    pub fn steps(&self, own: u64) -> u64 {
        self.max_steps.map_or(own, |most| own.min(most))
    }
}

/// Fitted model, and how its training ended.
pub struct Fitted {
    /// Fitted model.
    pub model: Box<dyn Model>,
    /// Reason why the training ended.
    pub reached: Reached,
    /// Number of steps taken.
    pub steps: u64,
}

/// Learner with its settings.
pub trait Learner: Send + Sync {
    /// Fits a model to the training part and chooses by the validation part; the test part is not used.
    ///
    /// # Errors
    /// [`LearnError`] with the reason.
    fn fit(&self, data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError>;
}

/// Entry of a learner in the registry.
pub struct Entry {
    /// Identifier, as in configurations.
    pub id: &'static str,
    /// Name for tables and reports.
    pub title: &'static str,
    /// One-sentence description of the method.
    pub summary: &'static str,
    /// Publication of the method.
    pub reference: &'static str,
    /// Kind of learned model.
    pub kind: Kind,
    /// Keys of the learner's section, `[ID]`.
    pub fields: &'static [Field],
    /// Builds the learner from its section.
    pub build: fn(&Resolved) -> Result<Box<dyn Learner>, SettingsError>,
    /// Restores the learner's model from a file.
    pub restore: fn(&Stored) -> Result<Box<dyn Model>, LearnError>,
}
