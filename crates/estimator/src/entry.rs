//! What a registry knows of an estimator.

use crate::context::FitContext;
use crate::error::FitError;
use crate::estimate::Estimate;
use envelope::Envelope;
use results::Estimand;
use settings::{Field, Resolved, SettingsError};

/// Property of an estimator, read by the test battery and the tables, so that nobody has
/// to ask for an estimator by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tag {
    /// Trains by steps: with a budget of zero steps it has to be wrong.
    Iterative,
    /// Draws random numbers: another seed takes another way.
    Seeded,
    /// States an uncertainty.
    Interval,
    /// Learns its skill from envelopes of its own making, before it sees the one it is asked about: its
    /// answer is as good as its training, not least squares to the last digits.
    Amortized,
    /// Estimates something else than the slope of the least-squares line, as a robust or a friction-aware
    /// method does: where its value differs from least squares it may be right.
    OwnEstimand,
    /// Has a learned part that can be held at zero, and an input that can be replaced by noise: it obeys
    /// [`FitContext::ablation`].
    Ablation,
    /// The floor row of tables: not meant to be right.
    Null,
}

/// An estimator with its settings in force.
///
/// `fit` takes `&self`: nothing learned lives in the estimator, so one can fit any number of
/// envelopes, from any number of threads.
pub trait Estimator: Send + Sync {
    /// Fits an envelope.
    ///
    /// # Errors
    /// [`FitError`] where there is no estimate to give. A fit that ran out of budget, was interrupted or
    /// diverged is no error: it gives the best estimate it has, and says so.
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError>;

    /// Does the part of the work that no envelope enters: an amortized estimator trains here, and what
    /// comes back only reads. Its fits equal this one's to the bit, given a context of the same seed and
    /// cap on the steps. `None` where there is no such part, as by default.
    ///
    /// # Errors
    /// As [`Estimator::fit`].
    fn pretrain(&self, context: &FitContext<'_>) -> Result<Option<Box<dyn Estimator>>, FitError> {
        let _ = context;
        Ok(None)
    }
}

/// A line of the registry: everything that is known of an estimator without building it.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Identifier in configurations and results, such as `pinn`.
    pub id: &'static str,
    /// Number in the paper's tables, where it is one of the paper's.
    pub paper_number: Option<u8>,
    /// Name in words.
    pub title: &'static str,
    /// Method, in a sentence.
    pub summary: &'static str,
    /// Properties of the estimator.
    pub tags: &'static [Tag],
    /// The literature it follows.
    pub citations: &'static [&'static str],
    /// Its configuration keys, within the section `estimator`.
    pub fields: &'static [Field],
    /// Builds it from checked settings.
    pub build: fn(&Resolved) -> Result<Box<dyn Estimator>, SettingsError>,
}

impl Entry {
    /// Returns whether the estimator carries a tag.
    #[must_use]
    pub fn has(&self, tag: Tag) -> bool {
        self.tags.contains(&tag)
    }

    /// Relation of its converged value to least squares, by its tags.
    #[must_use]
    pub fn estimand(&self) -> Estimand {
        if self.has(Tag::Null) {
            Estimand::Nothing
        } else if self.has(Tag::OwnEstimand) {
            Estimand::Own
        } else if self.has(Tag::Amortized) {
            Estimand::Approximation
        } else {
            Estimand::LeastSquares
        }
    }
}
