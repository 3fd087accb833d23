//! Weak-form sparse identification of the envelope's dynamics.
//!
//! The method searches for a law d ln A/dt = c₀ + Σ cₖ θₖ in a library of terms θₖ(A, t): a constant (viscous
//! damping), 1/A (dry friction), A (quadratic drag), and others on request. The scattered peaks are not
//! differentiated. The law is multiplied by test functions φ that vanish outside a part of the record and at
//! its ends, and integrated by parts:
//!
//! −∫φ′ ln A dt = c₀ ∫φ dt + Σ cₖ ∫φ θₖ dt.
//!
//! - **Test functions.** They have the form (1 − u²)^p from peak to peak: two steps wide, four, and so on up
//!   to the whole record, with functions of one width placed half a width apart. A function that the others
//!   already span is left out.
//! - **Covariance.** Overlapping test functions share the scatter of the peaks, which enters the left side
//!   with −φ′ and, through the terms, the right side with φ ∂θ/∂ln A. The regression is weighted by the
//!   inverse of the resulting covariance; law and covariance are updated in turn until neither changes.
//! - **Passes.** The bias of terms evaluated at scattered peaks remains. So the terms are then evaluated
//!   along the law's own trajectory, where the scatter is in the left side only, until the trajectory
//!   reproduces itself. A law that does not settle is dropped. `terms_along = "peaks"` skips this.
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
//! law's trajectory over the peak times. A weak form does not determine the initial value; it is chosen so
//! that the residuals at the peaks have mean zero.
//!
//! Test functions turn N peaks into at most N − 1 numbers, which do not depend on a constant added to ln A.
//! With fewer test functions information is lost: ten of them miss λ of the paper's envelope by 0.2 %. With
//! all of them and the right covariance nothing is lost, and the weighted regression of the constant law
//! gives the slope of the least-squares line to rounding, for any shape of the test functions. The default
//! allows all of them up to 200 steps between peaks. Then only the error of the quadrature between the peaks
//! remains, about 1e-8 of λ.
//!
//! # Interval
//!
//! The interval is Student's t on the scatter about the chosen law, with peaks minus parameters degrees of
//! freedom, carried over to λ by the weighted regression of a constant rate. It holds for scatter that is
//! independent from peak to peak, and is conditional on the choice of the law.
//!
//! # Predictions
//!
//! Predictions follow the law itself: its trajectory between the peaks, integrated forward beyond them and
//! backward before them. A law with dry friction comes to rest in a finite time, and ln A is −∞ from there
//! on. The standard deviation of a measured peak combines the scatter and its effect on the initial value and
//! the coefficients, by the delta method ([`sparse::Regression`]); like the interval it is conditional on
//! the choice of terms.
//!
//! References: Messenger, Bortz, Multiscale Modeling & Simulation 19 (2021) 1474 (weak form); Bortz,
//! Messenger, Dukic, Bulletin of Mathematical Biology 85 (2023) 110 (covariance); Boninsegna, Nüske, Clementi,
//! Journal of Chemical Physics 148 (2018) 241723 (one term at a time); Mangan et al., Proceedings of the Royal
//! Society A 473 (2017) 20170009 (choice by information criteria).

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod config;
mod fit;
mod sloped;
mod test_functions;
#[cfg(test)]
mod tests;
mod whitening;

pub use config::{TermsAlong, WeakSindyConfig};

use estimator::{Entry, Estimator, Tag};

/// Registry entry of the weak-form sparse identification.
pub const ENTRY: Entry = Entry {
    id: "weak-sindy",
    paper_number: Some(17),
    title: "Weak-form sparse identification of dynamics",
    summary: "Discovers the law of the envelope in a library of terms, by thresholded regression against \
              test functions, weighted by the covariance of the scatter.",
    tags: &[Tag::Iterative, Tag::Interval],
    citations: &[
        "Messenger, Bortz, Multiscale Modeling & Simulation 19 (2021) 1474-1497",
        "Bortz, Messenger, Dukic, Bulletin of Mathematical Biology 85 (2023) 110",
        "Boninsegna, Nüske, Clementi, Journal of Chemical Physics 148 (2018) 241723",
        "Mangan, Kutz, Brunton, Proctor, Proceedings of the Royal Society A 473 (2017) 20170009",
    ],
    fields: config::FIELDS,
    build: |settings| Ok(Box::new(WeakSindyConfig::read(settings)?) as Box<dyn Estimator>),
};
