//! Error of a fit that gives no estimate.

use thiserror::Error;

/// Error of a fit that gives no estimate.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FitError {
    /// The envelope has too few peaks for this method.
    #[error("{estimator} needs at least {needed} peaks; the envelope has {found}")]
    TooFewPeaks {
        /// Identifier of the estimator.
        estimator: &'static str,
        /// Number of peaks found.
        found: usize,
        /// Fewest peaks that it can work with.
        needed: usize,
    },
    /// The envelope has more peaks than the settings allow for this method.
    #[error(
        "{estimator} takes at most {most} peaks, since its time grows with their cube; the envelope has {found}: \
         thin the envelope or raise estimator.most_peaks"
    )]
    TooManyPeaks {
        /// Identifier of the estimator.
        estimator: &'static str,
        /// Number of peaks found.
        found: usize,
        /// Most peaks allowed.
        most: usize,
    },
    /// All amplitudes are the same, or their spread is not finite: there is nothing to scale by.
    #[error("the amplitudes of the envelope have a spread of {spread:?}: there is no decay to learn from")]
    NoSpread {
        /// Standard deviation of ln A.
        spread: f64,
    },
    /// The loss is not finite before the first step.
    #[error(
        "the loss is {loss} before the first step; lower estimator.initial_scale or the weights of \
         the loss"
    )]
    NotFinite {
        /// Value of the loss.
        loss: f64,
    },
    /// The fit's state could not be stored, or a stored state is not one of this fit.
    #[error("the state of the fit: {problem}")]
    Checkpoint {
        /// Cause of the failure.
        problem: String,
    },
    /// An estimator that runs outside of this program failed.
    #[error("{problem}")]
    Outside {
        /// Message of that estimator.
        problem: String,
    },
    /// The tensor library returned an error.
    #[error("the tensor library: {problem}")]
    Backend {
        /// Message of the library.
        problem: String,
    },
}
