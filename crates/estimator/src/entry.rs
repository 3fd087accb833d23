//! Registry entry of an estimator, its tags, and the trait that estimators implement.

use crate::context::FitContext;
use crate::error::FitError;
use crate::estimate::Estimate;
use envelope::Envelope;
use results::Estimand;
use settings::{Field, Resolved, SettingsError};

/// Property of an estimator. The test battery and the tables read it, so that no code has to ask for an
/// estimator by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tag {
    /// Trains step by step: with a budget of zero steps its estimate has to be wrong.
    Iterative,
    /// Draws random numbers: another seed gives another computation.
    Seeded,
    /// States an uncertainty.
    Interval,
    /// Is trained on simulated envelopes before it sees the measured one: its answer is as good as its
    /// training, and does not equal least squares to the last digits.
    Amortized,
    /// Estimates another quantity than the slope of the least-squares line, as a robust or a friction-aware
    /// method does: its value may be right where it differs from least squares.
    OwnEstimand,
    /// Has a learned part that can be held at zero and an input that can be replaced by noise: it follows
    /// [`FitContext::ablation`].
    Ablation,
    /// Gives the floor row of tables: it is not meant to be right.
    Null,
}

/// Estimator with its settings.
///
/// `fit` takes `&self`: the estimator holds nothing learned, so that one estimator can fit any number of
/// envelopes from any number of threads.
pub trait Estimator: Send + Sync {
    /// Fits an envelope.
    ///
    /// # Errors
    /// [`FitError`] if there is no estimate to give. A fit that ran out of budget, was interrupted or
    /// diverged is not an error: it gives the best estimate it has, and says so.
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError>;

    /// Does the part of the work that needs no envelope: an amortized estimator trains here, and the returned
    /// estimator only evaluates the trained model. Its fits equal this one's to the bit, given a context of
    /// the same seed and cap on the steps. `None` if the estimator has no such part, which is the default.
    ///
    /// # Errors
    /// The errors of [`Estimator::fit`].
    fn pretrain(&self, context: &FitContext<'_>) -> Result<Option<Box<dyn Estimator>>, FitError> {
        let _ = context;
        Ok(None)
    }
}

/// One row of the registry: everything that is known about an estimator without building it.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Identifier in configurations and results, such as `pinn`.
    pub id: &'static str,
    /// Number in the paper's tables; `None` if the paper does not have it.
    pub paper_number: Option<u8>,
    /// Human-readable name.
    pub title: &'static str,
    /// The method, in one sentence.
    pub summary: &'static str,
    /// Properties of the estimator.
    pub tags: &'static [Tag],
    /// Literature that the method follows.
    pub citations: &'static [&'static str],
    /// Configuration keys within the section `estimator`.
    pub fields: &'static [Field],
    /// Builds the estimator from checked settings.
    pub build: fn(&Resolved) -> Result<Box<dyn Estimator>, SettingsError>,
}

impl Entry {
    /// Returns `true` if the estimator carries a tag.
    #[must_use]
    pub fn has(&self, tag: Tag) -> bool {
        self.tags.contains(&tag)
    }

    /// Returns the relation of the estimator's converged value to least squares, derived from its tags.
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
