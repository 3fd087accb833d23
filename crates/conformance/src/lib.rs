//! Conformance battery that every estimator passes, as a library.
//!
//! A check is data ([`Check`]): a name, the estimators it applies to (by tag, never by name), and a function
//! that tests them. A test harness makes one test of each pair of estimator and check. A waiver states its
//! reason, and a waived check that passes is a failure too ([`verdict`]).
//!
//! No check needs to pass peaks out of order, repeated peaks, numbers that are not finite or fewer than three
//! peaks to an estimator, because the envelope's type refuses them. One test in this crate covers that
//! refusal ([`Envelope::new`](envelope::Envelope::new)).

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
pub use checks::{CHECKS, agrees_from_another_seed};
pub use cohort::{Cohort, Coverage, coverage};
pub use envelopes::{bent, exponential, scattered};
pub use line::{Line, least_squares};
pub use subject::{Subject, query_times};

use estimator::Entry;

/// One requirement on estimators.
#[derive(Debug, Clone, Copy)]
pub struct Check {
    /// Name of the check in test names.
    pub name: &'static str,
    /// Returns `true` for the estimators that the check applies to.
    pub applies: fn(&Entry) -> bool,
    /// Runs the check; a failure is returned as a sentence with numbers.
    pub run: fn(&Subject<'_>) -> Result<(), String>,
}

/// Exemption of an estimator from a check, with its reason.
#[derive(Debug, Clone, Copy)]
pub struct Waiver {
    /// Identifier of the estimator.
    pub estimator: &'static str,
    /// Name of the check.
    pub check: &'static str,
    /// Reason of the exemption.
    pub reason: &'static str,
}

/// Runs a check on an estimator under a list of waivers. Returns a remark if the check is waived and fails as
/// expected.
///
/// # Errors
/// Description of the failure: the check fails, or it is waived and passes.
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
