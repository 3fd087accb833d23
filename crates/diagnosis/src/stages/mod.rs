//! The stages of a diagnosis, each with what it hands on to the next.

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

/// What is asked.
#[derive(Clone, Copy)]
pub(crate) struct Request<'a> {
    pub(crate) records: &'a [Observations],
    pub(crate) simulator: &'a NominalSimulator,
    pub(crate) settings: &'a Settings,
}

/// How long each stage took, and who may end the work between two.
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

    /// Hands a stage's result on, and notes the time since the last one.
    ///
    /// # Errors
    /// [`DiagnosisError::Interrupted`] where the caller asks to stop.
    pub(crate) fn after<T>(&mut self, name: &'static str, result: T) -> Result<T, DiagnosisError> {
        self.note(name);
        if (self.goes_on)(name) { Ok(result) } else { Err(DiagnosisError::Interrupted { stage: name }) }
    }

    /// Notes the last stage, and gives all of them.
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
