//! What identification can fail of.

use thiserror::Error;

/// Why a record shows no oscillator.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum IdentifyError {
    /// Nothing moves.
    #[error("nothing moves in the record: all {samples} values of it are the same")]
    NoMotion {
        /// Samples there are.
        samples: usize,
    },
    /// Too short for its own time scale.
    #[error(
        "the record is too short to show an oscillator: {windows} windows of {width_s:.3} s fit into it, at least \
         {needed} are needed; give a longer record"
    )]
    TooShort {
        /// Windows that fit.
        windows: usize,
        /// Fewest that determine the coefficients.
        needed: usize,
        /// Width of a window, in seconds.
        width_s: f64,
    },
    /// The regression has no solution.
    #[error(
        "the record does not tell damping, stiffness and input apart: its motion is too simple; give a record with a \
         free decay or a richer input"
    )]
    Undetermined,
}
