//! Runs of a model: its motion with sensitivities.

use super::march::March;
use super::model::Model;
use super::response::{FullState, Response};
use crate::error::DynamicsError;
use crate::input::Input;

impl Model {
    /// Computes the motion at `times` from a start at the first of them, with its sensitivities.
    ///
    /// `times` are in seconds and never decrease; they may be uneven, and drifts, forcing and input count the
    /// same time. If hidden states start relaxed, the column of a start value includes their moving along.
    ///
    /// # Errors
    /// Returns [`DynamicsError::BadTimes`], [`DynamicsError::BadStart`], [`DynamicsError::Diverged`],
    /// [`DynamicsError::StepTooSmall`] or [`DynamicsError::TooManySteps`].
    pub fn run_into(
        &mut self,
        start: FullState,
        input: Option<&Input>,
        times: &[f64],
        response: &mut Response,
    ) -> Result<(), DynamicsError> {
        crate::times::check(times)?;
        crate::Start { position: start.position, velocity: start.velocity }.check()?;
        if let Some(&value) = start.hidden.iter().flatten().find(|value| !value.is_finite()) {
            return Err(DynamicsError::BadStart { what: "hidden state", value });
        }
        March::new(self, start, input, times, response).run()
    }

    /// Runs [`Self::run_into`] with new buffers.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::run_into`].
    pub fn run(
        &mut self,
        start: FullState,
        input: Option<&Input>,
        times: &[f64],
    ) -> Result<Response, DynamicsError> {
        let mut response = Response::default();
        self.run_into(start, input, times, &mut response)?;
        Ok(response)
    }
}
