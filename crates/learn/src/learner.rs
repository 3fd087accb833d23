//! What a learner is: a registry line, settings, and a fit.

use crate::data::DataSet;
use crate::{LearnError, Model, Stored};
use estimator::{Cancel, Checkpoints, FitContext, Reached, Silent};
use seed::Seed;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use settings::{Field, Resolved, SettingsError};

/// Form of what is learned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A torque as a function of the state: the model is a differential equation.
    Field,
    /// From a window of the past and the input to the future.
    Sequence,
    /// Coefficients of a stated law.
    Regressor,
}

impl Kind {
    /// Word for tables.
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
    /// Steps so far.
    pub step: u64,
    /// Part of the training, such as `whole records`.
    pub phase: String,
    /// Root mean square residual of the training part, in the position's unit.
    pub train: f64,
    /// Free-run error on the validation part, in the position's unit, where it was looked at.
    pub validation: Option<f64>,
}

/// What a learner is given besides the data.
pub struct Context<'a> {
    /// Root of its random draws.
    pub seed: Seed,
    /// Cap on the training steps; `None` leaves them to the learner's settings.
    pub max_steps: Option<u64>,
    /// Request to stop.
    pub cancel: &'a Cancel,
    /// Called after every step.
    pub observe: &'a dyn Fn(&Step),
    /// Where the state of a training is kept; `None` keeps none.
    pub checkpoints: Option<&'a dyn Checkpoints>,
}

impl Context<'_> {
    /// Refuses to go on where somebody asked to stop.
    ///
    /// # Errors
    /// [`LearnError::Interrupted`].
    pub fn check(&self) -> Result<(), LearnError> {
        if self.cancel.is_requested() { Err(LearnError::Interrupted) } else { Ok(()) }
    }

    /// The state to begin from, where one was kept.
    ///
    /// # Errors
    /// [`LearnError::Backend`] where it is none of this kind.
    pub fn resumed<T: DeserializeOwned>(&self) -> Result<Option<T>, LearnError> {
        Ok(self.kept().resumed()?)
    }

    /// Keeps a state where it is time to, or where the training is about to stop on request.
    ///
    /// # Errors
    /// [`LearnError::Backend`] where it cannot be kept.
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

    /// A budget within the cap.
    #[must_use]
    pub fn steps(&self, own: u64) -> u64 {
        self.max_steps.map_or(own, |most| own.min(most))
    }
}

/// A model, and how its training ended.
pub struct Fitted {
    /// The model.
    pub model: Box<dyn Model>,
    /// How the training ended.
    pub reached: Reached,
    /// Steps taken.
    pub steps: u64,
}

/// A learner with its settings.
pub trait Learner: Send + Sync {
    /// Learns from the training part, choosing by the validation part; the test part is not looked at.
    ///
    /// # Errors
    /// [`LearnError`] with what stands in the way.
    fn fit(&self, data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError>;
}

/// A line of the registry.
pub struct Entry {
    /// Identifier, as in configurations.
    pub id: &'static str,
    /// Name in words.
    pub title: &'static str,
    /// One sentence on the method.
    pub summary: &'static str,
    /// Where it comes from.
    pub reference: &'static str,
    /// Form of what is learned.
    pub kind: Kind,
    /// Keys of its section, `[ID]`.
    pub fields: &'static [Field],
    /// Makes it from its section.
    pub build: fn(&Resolved) -> Result<Box<dyn Learner>, SettingsError>,
    /// Makes its model from a file.
    pub restore: fn(&Stored) -> Result<Box<dyn Model>, LearnError>,
}
