//! Why a record has no envelope.

use thiserror::Error;

/// Why a record has no envelope.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EnvelopeError {
    /// Fewer peaks than a decay rate needs.
    #[error(
        "the {pipeline} pipeline finds {found} peak{}; a decay rate needs at least {needed}. {remedy}",
        if *found == 1 { "" } else { "s" }
    )]
    TooFewPeaks {
        /// The pipeline.
        pipeline: &'static str,
        /// Peaks found.
        found: usize,
        /// Fewest peaks that give a line and its error.
        needed: usize,
        /// What to try.
        remedy: String,
    },
    /// A peak at or below the rest position has no logarithm.
    #[error(
        "peak {number} at {time_s:.3} s lies {amplitude:.3e} {unit} from the rest position, on the \
         wrong side: its logarithm is undefined. Raise envelope.paper.prominence, or use the \
         recommended pipeline"
    )]
    AmplitudeNotPositive {
        /// Number of the peak, from 1.
        number: usize,
        /// Its time after the first sample, in seconds.
        time_s: f64,
        /// Its signed distance from the rest position.
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
        /// Step asked for, in seconds.
        step_s: f64,
        /// Points that would result.
        points: f64,
        /// Most points allowed.
        most: usize,
    },
    /// A smoothing window that does not fit.
    #[error(
        "a Savitzky-Golay window of {window} samples with order {order} does not fit {samples} \
         samples; expected an odd window above the order and at most the samples"
    )]
    SmoothingWindow {
        /// Window asked for, in samples.
        window: usize,
        /// Polynomial order asked for.
        order: usize,
        /// Samples there are.
        samples: usize,
    },
}
