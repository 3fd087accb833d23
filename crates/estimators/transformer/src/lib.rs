//! Transformer that attends over the envelope's peaks.
//!
//! Every peak is an entry: a linear embedding of its ln A, plus sines and cosines of its time. burn's
//! transformer encoder lets the entries attend to each other; a linear head without a bias computes a level
//! and a decay rate from the mean of its outputs. The decoder is the physical law ln A(t) = ln A₀ − λt, and
//! the loss is the mean squared error of the reconstructed peaks. λ is the decoder's. All weights are trained
//! by L-BFGS from random start values; Adam needs hundreds of steps for the same digits.
//!
//! Times enter only by their encoding, so that the order of the peaks has no effect on the network.
//!
//! The network is trained on the one envelope that it has to fit, so that its weights hold an answer and not
//! a general skill. Its minimum is the least-squares exponential, which it reaches to the last digits.
//!
//! [`AMORTIZED_ENTRY`] is the same network as an amortized estimator: trained on simulated envelopes only,
//! then applied to an envelope it never saw ([`neural::amortized`]).
//!
//! Reference: Vaswani et al., Attention is all you need, NeurIPS 30 (2017).

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod amortized;
mod config;
mod fit;
mod network;
#[cfg(test)]
mod tests;

pub use amortized::{AMORTIZED_ENTRY, AmortizedTransformerConfig};
pub use config::TransformerConfig;

use estimator::{Entry, Estimator, Tag};

/// Registry entry of the network trained on one envelope.
pub const ENTRY: Entry = Entry {
    id: "transformer",
    paper_number: Some(21),
    title: "Transformer",
    summary: "Attends over all peaks at once and outputs the exponential that reconstructs them.",
    tags: &[Tag::Iterative, Tag::Seeded, Tag::Interval, Tag::Ablation],
    citations: &[
        "Vaswani et al., Advances in Neural Information Processing Systems 30 (2017)",
        "Nocedal, Mathematics of Computation 35 (1980) 773-782",
    ],
    fields: config::FIELDS,
    build: |settings| {
        let config: TransformerConfig = settings.section("estimator")?;
        Ok(Box::new(config) as Box<dyn Estimator>)
    },
};
