//! Amortized networks: trained once on simulated envelopes, then used to read any envelope.
//!
//! A network gets a sequence with mean 0 and standard deviation 1. It returns a line, z ≈ c − r·s, and the
//! variances of c and r. It is trained on envelopes drawn from a stated [`Prior`], by the Gaussian likelihood
//! of each envelope's true line. An envelope is read in several looks: the first at the peaks themselves,
//! each later one at the residual of the current line, scaled to standard deviation 1 again. Looking ends
//! when a look changes the rate by less than a hundredth of its stated error. A single look therefore needs
//! no more accuracy than the scatter allows, even if the scatter is small compared with the decay, and a
//! decay added to the envelope is added to the answer.
//!
//! A sequence is read forward and backward, because a reversed envelope grows as fast as it decays.
//!
//! No line is fitted to the envelope: without training, a network's answer is almost meaningless, however
//! often it looks.
//!
//! Reference: repeated looks at the residual with the same network: Putzky, Welling, Recurrent inference
//! machines for solving inverse problems, arXiv:1706.04008 (2017); a network that states its variance: Nix,
//! Weigend, Proc. IEEE Int. Conf. Neural Networks (1994) 55; amortized inference: Cranmer, Brehmer, Louppe,
//! PNAS 117 (2020) 30055.

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
