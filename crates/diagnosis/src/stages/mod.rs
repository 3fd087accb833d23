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
pub(crate) use searched::Searched;

use crate::answer::Stage;
use crate::data::observations::Observations;
use crate::settings::Settings;
use dynamics::NominalSimulator;

/// What is asked.
#[derive(Clone, Copy)]
pub(crate) struct Request<'a> {
    pub(crate) records: &'a [Observations],
    pub(crate) simulator: &'a NominalSimulator,
    pub(crate) settings: &'a Settings,
}

/// How long each stage took.
pub(crate) struct Stopwatch<'a> {
    seconds: &'a dyn Fn() -> f64,
    last: f64,
    stages: Vec<Stage>,
}

impl<'a> Stopwatch<'a> {
    pub(crate) fn new(seconds: &'a dyn Fn() -> f64) -> Self {
        Self { seconds, last: seconds(), stages: Vec::new() }
    }

    /// Hands a stage's result on, and notes the time since the last one.
    pub(crate) fn after<T>(&mut self, name: &'static str, result: T) -> T {
        let now = (self.seconds)();
        self.stages.push(Stage { name, seconds: now - self.last });
        self.last = now;
        result
    }

    pub(crate) fn stages(self) -> Vec<Stage> {
        self.stages
    }
}
