//! Errors of the extraction of an envelope.

use thiserror::Error;

/// Reason why a record has no envelope.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EnvelopeError {
    /// Fewer peaks than a decay rate needs.
    #[error(
        "the {pipeline} pipeline finds {found} peak{}; a decay rate needs at least {needed}. {remedy}",
        if *found == 1 { "" } else { "s" }
    )]
    TooFewPeaks {
        /// Name of the pipeline.
        pipeline: &'static str,
        /// Number of peaks found.
        found: usize,
        /// Fewest peaks that give a line and its error.
        needed: usize,
        /// Advice to the user.
        remedy: String,
    },
    /// The motion comes back to rest without a swing.
    #[error(
        "the motion returns to rest without swinging, as an overdamped or critically damped system does: it has no \
         envelope. `trainer init` reads its damping ratio from the samples"
    )]
    NoSwing,
    /// A peak at or below the rest position has no logarithm.
    #[error(
        "peak {number} at {time_s:.3} s lies {amplitude:.3e} {unit} from the rest position, on the \
         wrong side: its logarithm is undefined. Raise envelope.paper.prominence, or use the \
         recommended pipeline"
    )]
    AmplitudeNotPositive {
        /// Number of the peak, from 1.
        number: usize,
        /// Time of the peak after the first sample, in seconds.
        time_s: f64,
        /// Signed distance of the peak from the rest position.
        amplitude: f64,
        /// Unit of the amplitude.
        unit: &'static str,
    },
    /// The grid would not fit into memory.
    #[error(
        "interpolating {duration_s:.1} s at {step_s} s makes {points:.0} points, more than {most}; \
         raise envelope.paper.interpolation_step_s"
    )]
    GridTooFine {
        /// Length of the record, in seconds.
        duration_s: f64,
        /// Step from the settings, in seconds.
        step_s: f64,
        /// Number of points that would result.
        points: f64,
        /// Most points allowed.
        most: usize,
    },
    /// A smoothing window does not fit the data.
    #[error(
        "a Savitzky-Golay window of {window} samples with order {order} does not fit {samples} \
         samples; expected an odd window above the order and at most the samples"
    )]
    SmoothingWindow {
        /// Window from the settings, in samples.
        window: usize,
        /// Polynomial order from the settings.
        order: usize,
        /// Number of samples in the data.
        samples: usize,
    },
}
