//! Generators of cases, one file for each way of making them.

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

/// Makes a case of a job's bank; `id` is the name of its folder.
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
    /// Makes the case with a number from 0. The case depends only on the seed, its bank and its number in
    /// that bank, and on no other case.
    ///
    /// # Errors
    /// [`TrialError`] for a number that is not below [`TrialPlan::len`], for systems, lengths and
    /// detectabilities that contradict each other, and for external files that cannot be read.
    pub fn case(&self, index: usize) -> Result<Case, TrialError> {
        // A shuffle assigns numbers to banks, so a folder's name reveals nothing.
        make(self, self.job(index)?, format!("{index:06}"))
    }
}
