//! Transformer that attends over the envelope's peaks.
//!
//! Every peak is an entry: its ln A through a linear embedding, plus sines and cosines of its time. burn's
//! transformer encoder lets the entries attend to each other; a linear head without a bias says a level
//! and a decay rate from the mean of what it gives. The decoder is physics, ln A(t) = ln A₀ − λt, and the
//! loss the mean squared error of the peaks it reconstructs. λ is the decoder's. Training is by L-BFGS on
//! all weights from random start values; Adam takes hundreds of steps to the same digits.
//!
//! Times enter by their encoding only, so the order in which the peaks are given tells the network
//! nothing.
//!
//! The network is trained on the one envelope it is asked about, so that its weights hold an answer, not
//! a skill. Its minimum is the exponential that fits best in the sense of least squares, and there it
//! arrives to the last digits.
//!
//! [`AMORTIZED_ENTRY`] is the same network with a skill instead: trained on simulated envelopes only, then
//! shown one it never saw ([`neural::amortized`]).
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

/// The registry's line.
pub const ENTRY: Entry = Entry {
    id: "transformer",
    paper_number: Some(21),
    title: "Transformer",
    summary: "Attends over the peaks, all at once, and says the exponential that reconstructs them.",
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
