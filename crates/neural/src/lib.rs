//! What the networks share on burn: double precision, affine-skip networks, encoders of a decay,
//! parameters as a flat list, Levenberg-Marquardt, limited-memory BFGS, Adam, safetensors; and how a network
//! learns to read envelopes in general ([`amortized`]).
//!
//! burn computes forward and backward passes; what is added here is what reaching many digits takes:
//! a device set to double precision, exact Jacobians of a network's values and of its input
//! derivatives, optimizers that know when rounding has the last word, and what the Jacobian at the optimum
//! says of the errors.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod adam;
mod affine_skip;
pub mod amortized;
mod decay;
mod device;
mod flat;
#[cfg(test)]
mod kept;
mod laplace;
mod lbfgs;
mod levenberg_marquardt;
mod memory;
mod minimum;
mod plain_network;
mod sequence;
mod weights;

pub use adam::Adam;
pub use affine_skip::{AffineSkipNetwork, Linearization};
pub use decay::{Differentiated, Encoder, Reconstruction};
pub use device::{DeviceKind, Precision, cpu_as_set, device, device_of, tensor, values};
pub use flat::{flat_gradient, named_parameters, with_parameters};
pub use laplace::Laplace;
pub use lbfgs::{Lbfgs, Smooth};
pub use levenberg_marquardt::{LeastSquares, LevenbergMarquardt, Linearized};
pub use memory::check_memory;
pub use minimum::{Iteration, Minimum, StopReason};
pub use plain_network::{Of, PlainNetwork};
pub use sequence::Sequence;
pub use weights::{NamedTensor, from_safetensors, to_safetensors};
