//! Experiment with everything that its fits need.

use crate::error::TrainerError;
use crate::fits::fit::SeedFit;
use crate::fits::input::Input;
use crate::folders::resume::Ledger;
use crate::options::Output;
use estimator::Cancel;
use experiment::Experiment;
use rayon::ThreadPool;
use results::SeedRow;
use runs::RunFolder;
use serde::Serialize;

/// Experiment that is ready to be fitted.
pub(crate) struct Run<'a> {
    pub(crate) experiment: &'a Experiment,
    pub(crate) input: Input,
    pub(crate) folder: RunFolder,
    pub(crate) ledger: Ledger,
    pub(crate) pool: ThreadPool,
    pub(crate) cancel: &'static Cancel,
    /// Number of steps of its trace after which each fit of an estimate pauses, to be resumed later.
    pub(crate) pause_after: Option<u64>,
    pub(crate) output: Output,
}

impl Run<'_> {
    /// Returns a fit as a row, with its error against the oracle's decay rate.
    pub(crate) fn row(&self, fit: &SeedFit) -> SeedRow {
        fit.row(&self.input.extraction.envelope, self.input.oracle.decay_rate)
    }

    /// Returns `true` if no progress is to be shown on the terminal.
    pub(crate) fn is_silent(&self) -> bool {
        self.output.quiet || self.output.json
    }

    /// Prints a result as [`Output::print`] does.
    pub(crate) fn print(
        &self,
        result: &impl Serialize,
        text: impl FnOnce() -> String,
    ) -> Result<(), TrainerError> {
        self.output.print(result, text)
    }
}
