//! The battery that every estimator passes, as a library.
//!
//! A check is data ([`Check`]): a name, the estimators it applies to (by tag, never by name), and what it
//! demands. Whoever runs the battery makes one test of each pair of estimator and check; a waiver
//! carries its reason, and a waived check that passes is a failure too ([`verdict`]).
//!
//! No check hands an estimator peaks in another order, the same peak twice, a number that is not finite or
//! fewer than three peaks: the envelope's type refuses them, so that there is nothing to hand over. One
//! test, here, holds that wall ([`Envelope::new`](envelope::Envelope::new)).

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod calibration;
mod checks;
mod cohort;
mod envelopes;
#[cfg(test)]
mod estimand_tests;
mod line;
mod subject;

pub use calibration::{Calibration, calibration};
pub use checks::CHECKS;
pub use cohort::{Cohort, Coverage, coverage};
pub use envelopes::{bent, exponential, scattered};
pub use line::{Line, least_squares};
pub use subject::{Subject, query_times};

use estimator::Entry;

/// One demand on estimators.
#[derive(Debug, Clone, Copy)]
pub struct Check {
    /// Name, as tests carry it.
    pub name: &'static str,
    /// Which estimators it applies to.
    pub applies: fn(&Entry) -> bool,
    /// Runs it; what is wrong comes back as a sentence with numbers.
    pub run: fn(&Subject<'_>) -> Result<(), String>,
}

/// A check that an estimator is let off, and why.
#[derive(Debug, Clone, Copy)]
pub struct Waiver {
    /// Identifier of the estimator.
    pub estimator: &'static str,
    /// Name of the check.
    pub check: &'static str,
    /// Why.
    pub reason: &'static str,
}

/// Runs a check on an estimator under a list of waivers: `Ok` with a remark where it is waived and fails
/// as expected.
///
/// # Errors
/// What is wrong: the check fails, or it is waived and passes.
pub fn verdict(check: &Check, subject: &Subject<'_>, waivers: &[Waiver]) -> Result<Option<String>, String> {
    let outcome = (check.run)(subject);
    let id = subject.entry.id;
    let waiver = waivers.iter().find(|waiver| waiver.estimator == id && waiver.check == check.name);
    match (outcome, waiver) {
        (Ok(()), None) => Ok(None),
        (Err(problem), None) => Err(problem),
        (Err(problem), Some(waiver)) => Ok(Some(format!("waived: {} ({problem})", waiver.reason))),
        (Ok(()), Some(waiver)) => Err(format!("passes, but is waived: {}; drop the waiver", waiver.reason)),
    }
}
