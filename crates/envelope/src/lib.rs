//! Extraction of the decay of a record's peaks: smoothing, peaks, offset, period.
//!
//! There are two pipelines. [`PaperPipeline`] repeats the paper's steps, so that its numbers can be checked.
//! [`RecommendedPipeline`] is the one we recommend: a believed clock, no resampling, peak positions between
//! the samples, both half-cycles. Both give an [`Envelope`], the only data that an estimator of the decay
//! rate receives.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod envelope;
mod error;
#[cfg(test)]
mod gap_tests;
mod interpolation;
mod paper;
mod peaks;
mod recommended;
mod savitzky_golay;
mod stretches;

pub use envelope::{Envelope, Extraction, RatioDefinition};
pub use error::EnvelopeError;
pub use interpolation::resample;
pub use paper::PaperPipeline;
pub use peaks::{find_peaks, local_maxima, prominences};
pub use recommended::RecommendedPipeline;
pub use record::noise_level;
pub use savitzky_golay::savitzky_golay;
