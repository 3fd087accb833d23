//! Sparse identification of the envelope's dynamics.
//!
//! The method searches for a law d ln A/dt = c₀ + Σ cₖ θₖ in a library of terms θₖ(A, t): a constant (viscous
//! damping), 1/A (dry friction), A (quadratic drag), and others on request. The scattered peaks are not
//! differentiated. The law is regressed in its integral form, with the initial value as an unknown:
//!
//! ln A(t) = ln A(0) + c₀ t + Σ cₖ ∫₀ᵗ θₖ dt′.
//!
//! - **Passes.** Terms evaluated at the measured peaks carry the peaks' scatter and bias the coefficients. So
//!   they are evaluated along the law's own trajectory (first at the measured peaks, then along the function
//!   of the last regression) until the trajectory reproduces itself. A law that does not settle is dropped.
//! - **Thresholds.** The terms are standardized over the peaks, and the threshold rises from zero. It stops
//!   just above the smallest coefficient; that term is dropped, and the others are regressed again. This
//!   gives one law for every number of terms.
//! - **Choice.** The result is the simplest law whose Bayesian information criterion is within `evidence` of
//!   the best. The number of peaks in it is the effective number of independent ones, from the residuals'
//!   autocorrelation.
//!
//! The constant is never thresholded: an envelope times exp(−δt) obeys the same law with δ added, so that a
//! set of laws without the constant would not be closed under an added damping.
//!
//! # Definition of λ
//!
//! If the law is c₀ alone, λ = −c₀. Otherwise λ is minus the slope of the least-squares line through the
//! law's trajectory over the peak times. In the integral form the regressors of the constant law are 1 and t:
//! with the initial value unknown, that regression is the least-squares line, and no other formulation of the
//! same law could differ. The residuals of richer laws are orthogonal to 1 and t as well, so that λ is that
//! of the line for every law. The method's contribution is the law: it shows whether the decay is an
//! exponential, and its form otherwise.
//!
//! # Interval
//!
//! The interval is Student's t on the scatter about the chosen law, with peaks minus parameters degrees of
//! freedom. It holds for scatter that is independent from peak to peak, and is conditional on the choice of
//! the law.
//!
//! # Predictions
//!
//! Predictions follow the law itself: its trajectory between the peaks, integrated forward beyond them and
//! backward before them. A law with dry friction comes to rest in a finite time, and ln A is −∞ from there
//! on. The standard deviation of a measured peak combines the scatter and its effect on the initial value and
//! the coefficients, by the delta method ([`sparse::Regression`]); like the interval it is conditional on
//! the choice of terms.
//!
//! References: Brunton, Proctor, Kutz, PNAS 113 (2016) 3932 (sequential thresholding); Schaeffer, McCalla,
//! Physical Review E 96 (2017) 023302 (integral form); Boninsegna, Nüske, Clementi, Journal of Chemical
//! Physics 148 (2018) 241723 (one term at a time); Mangan et al., Proceedings of the Royal Society A 473
//! (2017) 20170009 (choice by information criteria).

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod config;
mod fit;
#[cfg(test)]
mod tests;

pub use config::SindyConfig;

use estimator::{Entry, Estimator, Tag};

/// Registry entry of the sparse identification.
pub const ENTRY: Entry = Entry {
    id: "sindy",
    paper_number: Some(12),
    title: "Sparse identification of dynamics",
    summary: "Discovers the law of the envelope in a library of terms, by thresholded regression of its \
              integral form.",
    tags: &[Tag::Iterative, Tag::Interval],
    citations: &[
        "Brunton, Proctor, Kutz, PNAS 113 (2016) 3932-3937",
        "Schaeffer, McCalla, Physical Review E 96 (2017) 023302",
        "Boninsegna, Nüske, Clementi, Journal of Chemical Physics 148 (2018) 241723",
        "Mangan, Kutz, Brunton, Proctor, Proceedings of the Royal Society A 473 (2017) 20170009",
    ],
    fields: config::FIELDS,
    build: |settings| Ok(Box::new(SindyConfig::read(settings)?) as Box<dyn Estimator>),
};
