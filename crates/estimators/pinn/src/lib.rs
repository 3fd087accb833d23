//! Physics-informed neural network for the envelope's decay rate.
//!
//! The unknowns are a network f(t) for ln A(t) and a trainable λ. The loss has two terms: the network passes
//! near the measured ln A (data), and it obeys d ln A/dt + λ = 0 at collocation points (physics), with the
//! derivative computed exactly through the layers. It is trained by Levenberg–Marquardt on the exact
//! Jacobian, which copes with a large physics weight from the first step. Raising the weight in stages, as
//! gradient methods need it, took three times as many steps and gave no better rate. After every step the
//! last layer's weights, which enter the residuals linearly, take their best values given all other
//! parameters (variable projection).
//!
//! A finite physics weight w leaves the network some freedom to bend, and λ a bias that falls as 1/w. This is
//! a property of the method and not of its numerics.
//!
//! Predictions are the network's own values. The physics holds within the record only. Beyond it the network
//! is free, and the stated standard deviation, from a Laplace approximation, grows accordingly: on the
//! battery's bent envelope it is 0.10 at the end of the record and half a length beyond, 0.2 to 0.3 one
//! length beyond, and 6 to 24 four lengths beyond.
//!
//! Reference: Raissi, Perdikaris, Karniadakis, J. Comput. Phys. 378 (2019) 686.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod config;
mod fit;
mod objective;

pub use config::PinnConfig;

use estimator::{Entry, Estimator, Tag};
use neural::{AffineSkipNetwork, check_memory};

/// Registry entry of the physics-informed network.
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
        // One for λ, besides the network's parameters.
        let parameters = AffineSkipNetwork::parameter_count(&config.hidden) + 1;
        check_memory(settings, parameters, config.collocation_points)?;
        Ok(Box::new(config) as Box<dyn Estimator>)
    },
};
