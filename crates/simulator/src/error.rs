//! Errors of a simulated envelope.

use thiserror::Error;

/// Error for an envelope that cannot be simulated.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SimulationError {
    /// Dry friction ends the motion before the last peak.
    #[error(
        "dry friction ends the motion at turning point {reached} of {peaks}, where the amplitude is \
         {amplitude:.3e} and the dead zone {dead_zone:.3e}; ask for fewer peaks, a larger amplitude or a \
         smaller dead zone"
    )]
    ComesToRest {
        /// Number of the last turning point, from 1.
        reached: usize,
        /// Number of turning points requested.
        peaks: usize,
        /// Amplitude at the last turning point.
        amplitude: f64,
        /// Half-width of the dead zone, in the amplitude's unit.
        dead_zone: f64,
    },
    /// An amplitude is so small that additive scatter could turn it negative.
    #[error(
        "the smallest amplitude, {smallest:.3e}, is {ratio:.1} standard deviations of the scatter; a sensor's \
         envelope ends at {least}: ask for fewer peaks or less scatter"
    )]
    BelowTheScatter {
        /// Smallest noise-free amplitude.
        smallest: f64,
        /// Smallest amplitude in standard deviations of the scatter.
        ratio: f64,
        /// Smallest ratio that is simulated.
        least: f64,
    },
    /// A parameter is out of its range.
    #[error("{name} is {value:e}; expected {expected}")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Value of the parameter.
        value: f64,
        /// Admissible values.
        expected: &'static str,
    },
    /// The drawn peaks do not form an envelope.
    #[error("the drawn peaks make no envelope: {0}")]
    Envelope(#[from] envelope::EnvelopeError),
}
