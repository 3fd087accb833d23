//! Stages of a diagnosis, each with the result that the next one needs.

mod judged;
mod measured;
mod outcome;
mod question;
mod refined;
mod remaining;
mod searched;

pub(crate) use judged::Judged;
pub(crate) use measured::Measured;
pub(crate) use outcome::answer;
pub(crate) use question::Question;
pub(crate) use refined::Refined;
pub(crate) use remaining::Remaining;
pub(crate) use searched::{Known, Searched};

use crate::answer::Stage;
use crate::data::observations::Observations;
use crate::error::DiagnosisError;
use crate::settings::Settings;
use dynamics::NominalSimulator;

/// Request for a diagnosis: records, nominal simulator and settings.
#[derive(Clone, Copy)]
pub(crate) struct Request<'a> {
    pub(crate) records: &'a [Observations],
    pub(crate) simulator: &'a NominalSimulator,
    pub(crate) settings: &'a Settings,
}

/// Stopwatch for the stages, with the caller's test of whether to continue.
pub(crate) struct Stopwatch<'a> {
    seconds: &'a dyn Fn() -> f64,
    goes_on: &'a dyn Fn(&'static str) -> bool,
    last: f64,
    stages: Vec<Stage>,
}

impl<'a> Stopwatch<'a> {
    pub(crate) fn new(seconds: &'a dyn Fn() -> f64, goes_on: &'a dyn Fn(&'static str) -> bool) -> Self {
        Self { seconds, goes_on, last: seconds(), stages: Vec::new() }
    }

    /// Returns a stage's result, and records the time since the last stage.
    ///
    /// # Errors
    /// [`DiagnosisError::Interrupted`] if the caller asks to stop.
    pub(crate) fn after<T>(&mut self, name: &'static str, result: T) -> Result<T, DiagnosisError> {
        self.note(name);
        if (self.goes_on)(name) { Ok(result) } else { Err(DiagnosisError::Interrupted { stage: name }) }
    }

    /// Records the last stage, and returns all of them.
    pub(crate) fn last(mut self, name: &'static str) -> Vec<Stage> {
        self.note(name);
        self.stages
    }

    fn note(&mut self, name: &'static str) {
        let now = (self.seconds)();
        self.stages.push(Stage { name, seconds: now - self.last });
        self.last = now;
    }
}
