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

use crate::data::observations::Observations;
use crate::error::DiagnosisError;
use crate::settings::Settings;
use dynamics::NominalSimulator;
use results::StageRow;

/// Request for a diagnosis: records, nominal simulator and settings.
#[derive(Clone, Copy)]
pub(crate) struct Request<'a> {
    pub(crate) records: &'a [Observations],
    pub(crate) simulator: &'a NominalSimulator,
    pub(crate) settings: &'a Settings,
}

/// Stage of a diagnosis, in the order in which they run. Calibration and search may run more than once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Measurement of the records: clock, outliers, noise.
    MeasurementChain,
    /// Recalibration of the nominal simulator.
    Calibration,
    /// Search over sets of effects.
    Search,
    /// Fits of the best sets on every sample.
    Fits,
    /// Predictions of held-out parts.
    HeldOutParts,
    /// Tests of the residual for further effects.
    LeftOver,
    /// Shares, maps, rivals and the repaired simulator.
    Explanation,
}

impl Stage {
    /// Returns the name in results and messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::MeasurementChain => "measurement chain",
            Self::Calibration => "calibration",
            Self::Search => "search",
            Self::Fits => "fits",
            Self::HeldOutParts => "held-out parts",
            Self::LeftOver => "left-over",
            Self::Explanation => "explanation",
        }
    }
}

/// Stopwatch for the stages, with the caller's test of whether to continue.
pub(crate) struct Stopwatch<'a> {
    seconds: &'a dyn Fn() -> f64,
    goes_on: &'a dyn Fn(Stage) -> bool,
    last: f64,
    stages: Vec<StageRow>,
}

impl<'a> Stopwatch<'a> {
    pub(crate) fn new(seconds: &'a dyn Fn() -> f64, goes_on: &'a dyn Fn(Stage) -> bool) -> Self {
        Self { seconds, goes_on, last: seconds(), stages: Vec::new() }
    }

    /// Returns a stage's result, and records the time since the last stage.
    ///
    /// # Errors
    /// [`DiagnosisError::Interrupted`] if the caller asks to stop.
    pub(crate) fn after<T>(&mut self, stage: Stage, result: T) -> Result<T, DiagnosisError> {
        self.note(stage);
        if (self.goes_on)(stage) {
            Ok(result)
        } else {
            Err(DiagnosisError::Interrupted { stage: stage.name() })
        }
    }

    /// Records the last stage, and returns all of them.
    pub(crate) fn last(mut self, stage: Stage) -> Vec<StageRow> {
        self.note(stage);
        self.stages
    }

    fn note(&mut self, stage: Stage) {
        let now = (self.seconds)();
        self.stages.push(StageRow { name: stage.name().to_owned(), seconds: now - self.last });
        self.last = now;
    }
}
