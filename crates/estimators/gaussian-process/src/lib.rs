//! Gaussian-process regression of the envelope: a line, a smooth random function, and noise.
//!
//! ln A = a + b·t + g(t) + noise, with g a Gaussian process of zero mean and an RBF or Matérn covariance
//! ([`Kernel`]) and white noise. Line, signal, length scale and noise are trained together by Newton's method
//! on the restricted log likelihood with a prior of the ratio of signal to noise, from several drawn starts.
//!
//! λ is minus the slope of the least-squares line through the posterior mean **function**, line and g
//! together, at the peaks; not minus b, which on a bent envelope differs by ten per cent. At a maximum over
//! a and b, whatever the scales are, HᵀC⁻¹(y − H·(a, b)) = 0 for the columns H = (1, t) and the covariance C
//! of the values; the residuals y − f = σ_n²·C⁻¹(y − H·(a, b)) are then orthogonal to 1 and t, and the slope
//! of f is that of the data. So the trained process agrees with the least-squares line to rounding, 6e-16 on
//! the paper's record, without having been told; before it is trained it misses by tens of per cent.
//!
//! The interval is that of the posterior of the same slope. Under a flat prior of a and b its variance is
//! σ_n²/Σ(t − mean t)² for any covariance: g is known at the peaks as well as the noise lets it be, and its
//! bend is no uncertainty of the slope. A bent envelope therefore gets a narrower interval than the
//! least-squares line's, which takes the bend for scatter. Student's t with Satterthwaite's degrees of
//! freedom carries the uncertainty of σ_n. On simulated straight envelopes of 10 to 60 peaks 94.2 to 95.0 % of the
//! intervals hold the truth, 0.3 % fewer than of the least-squares line's own on the same envelopes.
//!
//! Predictions are the posterior mean of the function, and their standard deviation is that of a new measured
//! value under a flat prior of a and b, the scales taken as known. Beyond the peaks the function goes back to
//! its line within a length scale or two, and the deviation grows by what the signal may do there.
//!
//! Time goes with the cube of the number of peaks, hence `most_peaks`.
//!
//! Reference: Rasmussen, Williams, Gaussian Processes for Machine Learning (2006), chapters 2, 4 and 5.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod ascent;
mod config;
mod fit;
mod kernel;
mod likelihood;
#[cfg(test)]
mod tests;

pub use config::GaussianProcessConfig;
pub use kernel::Kernel;

use estimator::{Entry, Estimator, Tag};

/// The registry's line.
pub const ENTRY: Entry = Entry {
    id: "gaussian-process",
    paper_number: Some(20),
    title: "Gaussian process",
    summary: "A line plus a smooth random function plus noise; the slope of their posterior mean.",
    tags: &[Tag::Iterative, Tag::Seeded, Tag::Interval, Tag::Ablation],
    citations: &[
        "Rasmussen, Williams, Gaussian Processes for Machine Learning (2006)",
        "Patterson, Thompson, Biometrika 58 (1971) 545-554",
        "Gelman, Bayesian Analysis 1 (2006) 515-534",
        "Satterthwaite, Biometrics Bulletin 2 (1946) 110-114",
    ],
    fields: config::FIELDS,
    build: |settings| {
        let config: GaussianProcessConfig = settings.section("estimator")?;
        Ok(Box::new(config) as Box<dyn Estimator>)
    },
};
