//! Long short-term memory network that reads the envelope.
//!
//! burn's LSTM reads the peaks one after the other, each as its ln A and the time since the previous peak. A
//! linear head without a bias computes a level and a decay rate from the last hidden state. The decoder is
//! the physical law ln A(t) = ln A₀ − λt, and the loss is the mean squared error of the reconstructed peaks.
//! λ is the decoder's. All weights are trained by L-BFGS from random start values; Adam needs hundreds of
//! steps for the same digits.
//!
//! The network is trained on the one envelope that it has to fit, so that its weights hold an answer and not
//! a general skill. Its minimum is the least-squares exponential, which it reaches to the last digits.
//!
//! [`AMORTIZED_ENTRY`] is the same network as an amortized estimator: trained on simulated envelopes only,
//! then applied to an envelope it never saw ([`neural::amortized`]).
//!
//! Reference: Hochreiter, Schmidhuber, Neural Computation 9 (1997) 1735; the forget gate: Gers,
//! Schmidhuber, Cummins, Neural Computation 12 (2000) 2451.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod amortized;
mod backpropagation;
mod config;
mod fit;
mod network;
#[cfg(test)]
mod tests;

pub use amortized::{AMORTIZED_ENTRY, AmortizedLstmConfig};
pub use config::LstmConfig;

use estimator::{Entry, Estimator, Tag};

/// Registry entry of the network trained on one envelope.
pub const ENTRY: Entry = Entry {
    id: "lstm",
    paper_number: Some(15),
    title: "Long short-term memory network",
    summary: "Reads the peaks one after the other and outputs the exponential that reconstructs them.",
    tags: &[Tag::Iterative, Tag::Seeded, Tag::Interval, Tag::Ablation],
    citations: &[
        "Hochreiter, Schmidhuber, Neural Computation 9 (1997) 1735-1780",
        "Nocedal, Mathematics of Computation 35 (1980) 773-782",
    ],
    fields: config::FIELDS,
    build: |settings| {
        let config: LstmConfig = settings.section("estimator")?;
        Ok(Box::new(config) as Box<dyn Estimator>)
    },
};
