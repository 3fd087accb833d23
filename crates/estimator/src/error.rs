//! Why an estimator gives no estimate.

use thiserror::Error;

/// Why an estimator gives no estimate.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FitError {
    /// The envelope has too few peaks for this method.
    #[error("{estimator} needs at least {needed} peaks; the envelope has {found}")]
    TooFewPeaks {
        /// The estimator.
        estimator: &'static str,
        /// Peaks found.
        found: usize,
        /// Fewest peaks it can work with.
        needed: usize,
    },
    /// The envelope has more peaks than this method is allowed to spend its time on.
    #[error(
        "{estimator} takes at most {most} peaks, since its time grows with their cube; the envelope has {found}: \
         thin the envelope or raise estimator.most_peaks"
    )]
    TooManyPeaks {
        /// The estimator.
        estimator: &'static str,
        /// Peaks found.
        found: usize,
        /// Most peaks allowed.
        most: usize,
    },
    /// Every amplitude is the same, or the spread is not finite: nothing to scale by.
    #[error("the amplitudes of the envelope have a spread of {spread:?}: there is no decay to learn from")]
    NoSpread {
        /// Standard deviation of ln A.
        spread: f64,
    },
    /// The loss was not finite from the start.
    #[error(
        "the loss is {loss} before the first step; lower estimator.initial_scale or the weights of \
         the loss"
    )]
    NotFinite {
        /// The loss.
        loss: f64,
    },
    /// The fit's state could not be kept, or one that was kept is not a state of this fit.
    #[error("the state of the fit: {problem}")]
    Checkpoint {
        /// What went wrong.
        problem: String,
    },
    /// An estimator that works outside of this program failed.
    #[error("{problem}")]
    Outside {
        /// What it says.
        problem: String,
    },
    /// The tensor library refused.
    #[error("the tensor library: {problem}")]
    Backend {
        /// What it says.
        problem: String,
    },
}
