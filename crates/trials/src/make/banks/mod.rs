//! One file for each way in which a bank's cases come about.

mod composite;
mod engine;
mod foreign;
mod measured;
mod own_record;
mod rigs;
mod stressed;
mod vocabulary;

#[cfg(test)]
pub(crate) use rigs::{RigTruth, hidden};

use super::case::Case;
use super::error::TrialError;
use super::job::Job;
use super::plan::TrialPlan;
use crate::Bank;

/// Draws a case of a job's bank, with the name of its folder.
pub(crate) fn make(plan: &TrialPlan, job: Job, id: String) -> Result<Case, TrialError> {
    match job.bank {
        Bank::None
        | Bank::Calibration
        | Bank::Single
        | Bank::Pair
        | Bank::LeftOut
        | Bank::Releases
        | Bank::Driven => vocabulary::make(plan, job, id),
        Bank::Foreign => foreign::make(plan, job, id),
        Bank::Stressed => stressed::make(plan, job, id),
        Bank::Measured => measured::make(plan, job, id),
        Bank::Engine => engine::make(plan, job, id),
        Bank::Composite => composite::make(plan, job, id),
        Bank::Rigs => rigs::make(plan, job, id),
    }
}

impl TrialPlan {
    /// The case with a number from 0. It depends on the seed and on its bank and number there alone, and on
    /// no other case.
    ///
    /// # Errors
    /// [`TrialError`]: a number beyond [`TrialPlan::len`]; systems, lengths and detectabilities that do not
    /// go together; files from outside that cannot be read.
    pub fn case(&self, index: usize) -> Result<Case, TrialError> {
        // Numbers are dealt to banks by a shuffle: a folder's name betrays nothing.
        make(self, self.job(index)?, format!("{index:06}"))
    }
}
