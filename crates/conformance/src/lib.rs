//! The battery that every estimator passes, as a library.
//!
//! A check is data ([`Check`]): a name, the estimators it applies to (by tag, never by name), and what it
//! demands. Whoever runs the battery makes one test of each pair of estimator and check; a waiver
//! carries its reason, and a waived check that passes is a failure too ([`verdict`]).

mod calibration;
mod checks;
mod cohort;
mod envelopes;

pub use calibration::{Calibration, calibration};
pub use checks::CHECKS;
pub use cohort::{Coverage, coverage};
pub use envelopes::{bent, exponential, scattered};

use envelope::Envelope;
use estimator::{Cancel, Entry, Estimate, Estimator, FitContext, FitError, Silent};
use seed::Seed;
use settings::{Document, Resolved, Section, SettingsError};

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

/// An estimator under test, with its default settings.
pub struct Subject<'a> {
    /// The registry's line.
    pub entry: &'a Entry,
    /// The estimator.
    pub estimator: Box<dyn Estimator>,
}

impl<'a> Subject<'a> {
    /// The estimator with its default settings.
    ///
    /// # Errors
    /// What building it gives; every estimator has to build from its defaults.
    pub fn new(entry: &'a Entry) -> Result<Self, SettingsError> {
        let section = [Section { name: "estimator", fields: entry.fields }];
        let resolved = Resolved::new(&Document::default(), &section)?;
        Ok(Self { entry, estimator: (entry.build)(&resolved)? })
    }

    /// A fit with a seed and a cap on the steps.
    ///
    /// # Errors
    /// What the fit gives.
    pub fn fit(&self, envelope: &Envelope, seed: u64, max_steps: Option<u64>) -> Result<Estimate, FitError> {
        let cancel = Cancel::new();
        let branch = Seed::new(seed).child(self.entry.id);
        let context = FitContext::new(branch, max_steps, &Silent, &cancel);
        self.estimator.fit(envelope, &context)
    }
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
/// What is wrong: the check fails, or it is waived and passes, or the estimator does not build.
pub fn verdict(check: &Check, entry: &Entry, waivers: &[Waiver]) -> Result<Option<String>, String> {
    let subject = Subject::new(entry).map_err(|error| error.to_string())?;
    let outcome = (check.run)(&subject);
    let waiver = waivers.iter().find(|waiver| waiver.estimator == entry.id && waiver.check == check.name);
    match (outcome, waiver) {
        (Ok(()), None) => Ok(None),
        (Err(problem), None) => Err(problem),
        (Err(problem), Some(waiver)) => Ok(Some(format!("waived: {} ({problem})", waiver.reason))),
        (Ok(()), Some(waiver)) => Err(format!("passes, but is waived: {}; drop the waiver", waiver.reason)),
    }
}
