//! Tools on burn that the networks share: double precision, affine-skip networks, encoders of a decay, flat
//! parameter lists, Levenberg–Marquardt, limited-memory BFGS, Adam, safetensors files, and amortized reading
//! of envelopes ([`amortized`]).
//!
//! burn computes forward and backward passes. This crate adds what high accuracy requires: a device set to
//! double precision, exact Jacobians of a network's values and of its input derivatives, optimizers that
//! detect when rounding errors dominate, and error estimates from the Jacobian at the optimum.

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
pub use least_squares::{Iteration, LeastSquares, Linearized, Minimum, StopReason};
pub use levenberg_marquardt::LevenbergMarquardt;
pub use memory::check_memory;
pub use plain_network::{Of, PlainNetwork};
pub use sequence::Sequence;
pub use weights::{NamedTensor, from_safetensors, to_safetensors};
