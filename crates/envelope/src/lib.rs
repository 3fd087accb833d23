//! From a record to the decay of its peaks: smoothing, peaks, offset, period.
//!
//! Two pipelines, by name. [`PaperPipeline`] does what the paper did, step by step, so that its numbers
//! can be checked. [`RecommendedPipeline`] is what we would do: a believed clock, no resampling, peak
//! positions between the samples, both half-cycles. Either gives an [`Envelope`]: all that an estimator
//! of the decay rate gets to see.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod envelope;
mod error;
#[cfg(test)]
mod gap_tests;
mod interpolation;
mod noise;
mod paper;
mod peaks;
mod recommended;
mod savitzky_golay;
mod stretches;

pub use envelope::{Envelope, Extraction, RatioDefinition};
pub use error::EnvelopeError;
pub use interpolation::resample;
pub use noise::noise_level;
pub use paper::PaperPipeline;
pub use peaks::{find_peaks, local_maxima, prominences};
pub use recommended::RecommendedPipeline;
pub use savitzky_golay::savitzky_golay;
