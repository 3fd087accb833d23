//! Why there is nothing to simulate.

use thiserror::Error;

/// Why there is nothing to simulate.
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
        /// Turning points asked for.
        peaks: usize,
        /// The amplitude there.
        amplitude: f64,
        /// Half-width of the dead zone, in the amplitude's unit.
        dead_zone: f64,
    },
    /// An amplitude so small that additive scatter could turn it negative.
    #[error(
        "the smallest amplitude, {smallest:.3e}, is {ratio:.1} standard deviations of the scatter; a sensor's \
         envelope ends at {least}: ask for fewer peaks or less scatter"
    )]
    BelowTheScatter {
        /// The smallest noise-free amplitude.
        smallest: f64,
        /// It in standard deviations of the scatter.
        ratio: f64,
        /// The least that is simulated.
        least: f64,
    },
    /// Parameters that make no envelope.
    #[error("{name} is {value:e}; expected {expected}")]
    Parameter {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it has to be.
        expected: &'static str,
    },
    /// The drawn peaks make no envelope.
    #[error("the drawn peaks make no envelope: {0}")]
    Envelope(#[from] envelope::EnvelopeError),
}
