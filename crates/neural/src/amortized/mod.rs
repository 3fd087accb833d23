//! Networks that learn to read envelopes in general: trained on simulated ones, then shown the one in
//! question.
//!
//! A network is handed a sequence of mean 0 and spread 1 and says a line, z ≈ c − r·s, and how well it
//! knows c and r. It is trained on envelopes drawn from a stated [`Prior`], by the Gaussian likelihood of
//! the line behind each. Reading an envelope it looks several times: at the peaks themselves first, then
//! at what its line has left over, brought to spread 1 again, until a look moves the rate by a hundredth
//! of its stated error. So the accuracy it needs at one look is that of the scatter, however small the
//! scatter is beside the decay, and a decay added to the envelope is added to the answer.
//!
//! It reads forward and backward: told backward, an envelope grows as fast as it decays.
//!
//! No line is fitted to the envelope: without its training a network says next to nothing, however often
//! it looks.
//!
//! Reference: looking again at what is left with the same network: Putzky, Welling, Recurrent inference
//! machines for solving inverse problems, arXiv:1706.04008 (2017); a network that states its variance:
//! Nix, Weigend, Proc. IEEE Int. Conf. Neural Networks (1994) 55; amortized inference: Cranmer, Brehmer,
//! Louppe, PNAS 117 (2020) 30055.

mod bank;
mod calibration;
mod estimator;
pub mod fields;
mod mirror;
mod reading;
#[cfg(test)]
mod tiny;
mod training;

pub use bank::{Example, Prior};
pub use estimator::{Amortized, Skilled};
pub use training::Training;
