//! Long short-term memory network that reads the envelope.
//!
//! burn's LSTM reads the peaks one after the other, each as the time since the one before and its ln A.
//! A linear head without a bias says a level and a decay rate from the last hidden state; the decoder is
//! physics, ln A(t) = ln A₀ − λt, and the loss the mean squared error of the peaks it reconstructs. λ is
//! the decoder's. Training is by L-BFGS on all weights from random start values; Adam takes hundreds of
//! steps to the same digits.
//!
//! The network is trained on the one envelope it is asked about, so that its weights hold an answer, not
//! a skill. Its minimum is the exponential that fits best in the sense of least squares, and there it
//! arrives to the last digits.
//!
//! [`AMORTIZED_ENTRY`] is the same network with a skill instead: trained on simulated envelopes only, then
//! shown one it never saw ([`neural::amortized`]).
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

/// The registry's line.
pub const ENTRY: Entry = Entry {
    id: "lstm",
    paper_number: Some(15),
    title: "Long short-term memory network",
    summary: "Reads the peaks one after the other and says the exponential that reconstructs them.",
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
