//! Errors of identification.

use thiserror::Error;

/// Reason why no oscillator can be identified from a record.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum IdentifyError {
    /// All values of the record are the same.
    #[error("nothing moves in the record: all {samples} values of it are the same")]
    NoMotion {
        /// Number of samples in the record.
        samples: usize,
    },
    /// The record is too short for its own time scale.
    #[error(
        "the record is too short to show an oscillator: {windows} windows of {width_s:.3} s fit into it, at least \
         {needed} are needed; give a longer record"
    )]
    TooShort {
        /// Number of windows that fit into the record.
        windows: usize,
        /// Fewest windows that determine the coefficients.
        needed: usize,
        /// Width of a window, in seconds.
        width_s: f64,
    },
    /// The regression has no unique solution.
    #[error(
        "the record does not determine damping, stiffness and input separately: its motion is too simple; \
         give a record with a free decay or a richer input"
    )]
    Undetermined,
}
