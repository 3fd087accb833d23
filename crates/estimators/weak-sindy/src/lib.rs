//! Weak-form sparse identification of the envelope's dynamics.
//!
//! A law d ln A/dt = c₀ + Σ cₖ θₖ is sought in a library of terms θₖ(A, t): a constant (viscous damping),
//! 1/A (dry friction), A (quadratic drag), and others on request. No derivative is taken of the scattered
//! peaks. The law is multiplied by test functions φ that vanish outside a part of the record and at its
//! ends, and integrated by parts:
//!
//! −∫φ′ ln A dt = c₀ ∫φ dt + Σ cₖ ∫φ θₖ dt.
//!
//! - **Test functions.** (1 − u²)^p from peak to peak: two steps wide, four, and so on to the whole record, each
//!   width in places half a width apart; none is kept that the others already span.
//! - **Covariance.** Overlapping test functions share the scatter of the peaks, which enters the left side
//!   with −φ′ and, through the terms, the right side with φ ∂θ/∂ln A. The regression is weighted by the
//!   inverse of the covariance this gives, law and covariance in turns until neither changes.
//! - **Passes.** That leaves the bias of terms evaluated at scattered peaks. So the terms are then evaluated
//!   along the law's own trajectory, where the scatter is in the left side only, until the trajectory
//!   reproduces itself. A law that does not settle is dropped. `terms_along = "peaks"` leaves this out.
//! - **Thresholds.** The terms are standardized over the peaks, and the threshold rises from zero: it
//!   stops just above the smallest coefficient, which falls, and the rest is regressed anew. This gives
//!   one law for every number of terms.
//! - **Choice.** The simplest law whose Bayesian information criterion is within `evidence` of the best,
//!   the peaks counted as the independent ones that the residuals' autocorrelation leaves.
//!
//! The constant is never thresholded: an envelope times exp(−δt) obeys the same law with δ added, so that a
//! set of laws without it would not be closed under what an added damping does.
//!
//! # What λ is
//!
//! Where the law is c₀ alone, λ = −c₀. Otherwise λ is minus the slope of the least-squares projection of the
//! law's trajectory on a line over the peak times; the initial value, which a weak form does not know, is the
//! one that leaves the peaks no mean residual.
//!
//! Test functions turn N peaks into at most N − 1 numbers, which a constant added to ln A leaves alone. With
//! fewer, something is lost: ten allowed ones miss λ of the paper's envelope by 0.2 %. With all of them and
//! the right covariance nothing is, and the weighted regression of the constant law gives the slope of the
//! least-squares line to rounding, whatever the shape of the test functions. The default allows all up to
//! 200 steps between peaks. What is left then is the quadrature between the peaks, about 1e-8 of λ.
//!
//! # Interval
//!
//! Student's t on the scatter about the chosen law, peaks minus parameters degrees of freedom, carried to λ by
//! the weighted regression of a constant rate. It holds for scatter that is independent from peak to peak and
//! is conditional on the choice.
//!
//! # Predictions
//!
//! The law itself: its trajectory between the peaks, integrated on beyond them and backward before them. A law
//! with dry friction comes to rest in a finite time, and ln A is −∞ from there on. The standard deviation of a
//! measured peak is that of the scatter and of what it does to the initial value and the coefficients, by the
//! delta method ([`sparse::predictions`]); like the interval it is conditional on the choice of terms.
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

/// The registry's line.
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
