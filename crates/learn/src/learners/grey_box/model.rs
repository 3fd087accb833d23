//! Grey-box law as a model.

use super::fit::{Point, Prior, Runs};
use super::form::Form;
use super::law::State;
use super::run::Piece;
use crate::data::Trajectory;
use crate::flow::Running;
use crate::{Ahead, Coefficient, LearnError, Model, Past, Place, Predicted, Stored, Tensor, Torque};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Identifier of the learner.
pub(super) const ID: &str = "grey-box";

/// Fitted law. The start state of a prediction is the one that fits the past best.
pub(super) struct GreyBox {
    pub(super) about: About,
    pub(super) parameters: Vec<f64>,
    pub(super) coefficients: Vec<Coefficient>,
}

/// Contents of a model's file beside the numbers.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct About {
    pub(super) form: Form,
    pub(super) running: Running,
    pub(super) state_sizes: State,
    /// Typical size of the observed quantity.
    pub(super) spread: f64,
    /// Unit of the positions.
    pub(super) unit: String,
    /// Prior of the hidden state at a start, if the law has one.
    #[serde(default)]
    pub(super) prior: Option<Prior>,
    /// Error on the validation part of the law as it was chosen, if it was fitted to that part afterwards.
    #[serde(default)]
    pub(super) validation: Option<f64>,
}

/// Largest number of steps of a search for a start state.
const MOST_STEPS: u64 = 40;

impl GreyBox {
    /// Builds a model from its numbers.
    pub(super) fn new(about: About, parameters: Vec<f64>) -> Self {
        let law = about.form.law();
        let named = law.names(&about.unit).into_iter().zip(law.stated(&parameters));
        let coefficient =
            |((name, unit), value)| Coefficient { name, value, unit, std_error: None, inclusion: None };
        let coefficients = named.map(coefficient).collect();
        Self { about, parameters, coefficients }
    }

    /// Restores a model from its file.
    ///
    /// # Errors
    /// [`LearnError::Stored`] for a file of another form.
    pub(super) fn restored(stored: &Stored) -> Result<Self, LearnError> {
        let about: About = stored.described()?;
        let parameters = stored.tensor("parameters")?.values.clone();
        let expected = about.form.law().names(&about.unit).len();
        if parameters.len() != expected {
            let problem = format!("{} parameters where the law has {expected}", parameters.len());
            return Err(LearnError::Stored { problem });
        }
        Ok(Self::new(about, parameters))
    }

    /// Estimates the state at the first sample of a past: the most probable one, where a short past tells little of a
    /// hidden state. The law's own error, not only the sensor's noise, stands between its runs and the samples.
    pub(super) fn start(&self, past: &Trajectory) -> Result<State, LearnError> {
        let About { form, running, state_sizes, spread, prior, .. } = &self.about;
        let piece = Piece::new(past, running)?;
        let runs = Runs {
            law: form.law(),
            pieces: std::slice::from_ref(&piece),
            running,
            sizes: &[],
            state_sizes: *state_sizes,
            free: &[],
            spread: *spread,
            prior: *prior,
        };
        // A law without a hidden state starts without one.
        let hidden = prior.map_or(0.0, |prior| prior.mean);
        let start = form.law().start(past, running.period_s, hidden);
        let from = Point { parameters: self.parameters.clone(), starts: vec![start] };
        let (found, _) = runs.fit(&from, MOST_STEPS, |_, _| ControlFlow::Continue(()))?;
        Ok(found.starts.first().copied().unwrap_or(start))
    }
}

impl Model for GreyBox {
    fn free_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        let About { form, running, .. } = &self.about;
        let (times, values) = (past.times_s.to_vec(), past.values.to_vec());
        let start = self.start(&Trajectory::new("past", times, values, past.input.map(<[f64]>::to_vec))?)?;
        let times = [past.times_s, ahead.times_s].concat();
        let input = past.input.zip(ahead.input).map(|(before, after)| [before, after].concat());
        let whole = Trajectory::new("whole", times.clone(), times, input)?;
        let found = form.law().motion(&self.parameters, start, &Piece::new(&whole, running)?, running);
        if let Some(time_s) = found.diverged_s {
            return Err(LearnError::Diverged { time_s, bound: running.bound });
        }
        // If the past covers all times, nothing lies ahead.
        let values = found.positions.get(past.times_s.len()..).unwrap_or_default().to_vec();
        Ok(Predicted { values, std: None })
    }

    fn parameters(&self) -> usize {
        self.parameters.len()
    }

    fn coefficients(&self) -> &[Coefficient] {
        &self.coefficients
    }

    fn torque(&self, place: &Place) -> Option<Torque> {
        let value = self.about.form.law().acceleration(&self.parameters, place)?;
        Some(Torque { value, std: None })
    }

    fn validation(&self) -> Option<f64> {
        self.about.validation
    }

    fn equation(&self) -> Option<String> {
        Some(self.about.form.law().equation(&self.parameters))
    }

    fn stored(&self) -> Option<Stored> {
        let tensor = |name: &str, values: &[f64]| Tensor {
            name: name.to_owned(),
            shape: vec![values.len()],
            values: values.to_vec(),
        };
        let tensors = vec![tensor("parameters", &self.parameters)];
        Stored::new(ID, &self.about, tensors).ok()
    }
}
