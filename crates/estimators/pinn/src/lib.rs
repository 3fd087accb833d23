//! Physics-informed neural network for the envelope's decay rate.
//!
//! A network f(t) for ln A(t) and a trainable λ. Two terms of the loss: the network passes near the
//! measured ln A (data), and it obeys d ln A/dt + λ = 0 at collocation points (physics), the derivative
//! taken exactly through the layers. It is trained by Levenberg–Marquardt on the exact Jacobian, which
//! copes with a large physics weight from the first step; raising the weight in stages, as gradient
//! methods need it, took three times the steps and gave no better rate. After every step the last layer's weights, which enter the
//! residuals linearly, take their best values for everything else (variable projection).
//!
//! A finite physics weight w leaves the network some freedom to bend, and λ a bias that falls as 1/w.
//! That is part of the method, not of its numerics.
//!
//! Predictions are the network's own values. The physics is asked for within the record only; beyond it the
//! network is free, and the stated standard deviation, that of a Laplace approximation, grows accordingly:
//! on the battery's bent envelope it is 0.10 at its end and half a length on, 0.2 to 0.3 a length on, and
//! 6 to 24 four lengths on.
//!
//! Reference: Raissi, Perdikaris, Karniadakis, J. Comput. Phys. 378 (2019) 686.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod config;
mod fit;
mod objective;

pub use config::PinnConfig;

use estimator::{Entry, Estimator, Tag};
use neural::{AffineSkipNetwork, check_memory};

/// The registry's line.
pub const ENTRY: Entry = Entry {
    id: "pinn",
    paper_number: Some(13),
    title: "Physics-informed neural network",
    summary: "A network for ln A(t) and a trainable decay rate, tied by the residual of d ln A/dt + λ.",
    tags: &[Tag::Iterative, Tag::Seeded, Tag::Interval, Tag::Ablation],
    citations: &[
        "Raissi, Perdikaris, Karniadakis, Journal of Computational Physics 378 (2019) 686-707",
        "Marquardt, SIAM Journal on Applied Mathematics 11 (1963) 431-441",
        "Golub, Pereyra, SIAM Journal on Numerical Analysis 10 (1973) 413-432",
    ],
    fields: config::FIELDS,
    build: |settings| {
        let config: PinnConfig = settings.section("estimator")?;
        // λ beside the network's.
        let parameters = AffineSkipNetwork::parameter_count(&config.hidden) + 1;
        check_memory(settings, parameters, config.collocation_points)?;
        Ok(Box::new(config) as Box<dyn Estimator>)
    },
};
