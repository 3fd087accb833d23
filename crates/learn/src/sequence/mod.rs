//! Sequence models: maps from a window of the past and the input to the future.
//!
//! A model predicts a block of samples at once: a linear prediction (an autoregression's free run), corrected
//! by a network that reads the past, the input over past and block, and the linear prediction itself. A free
//! run is a chain of blocks, each of which takes the previous predictions as its past. Training minimizes the
//! error of free runs of several blocks; the gradient is passed back from block to block. If the network's
//! correction is zero, the model is the autoregression.
//!
//! A new architecture is one file: a configuration that implements [`Architecture`], a burn module that
//! implements [`Network`], and an [`Entry`](crate::Entry) with [`build`] and [`restore`]. This module
//! supplies everything else.
//!
//! Bengio, Vinyals, Jaitly, Shazeer, NeurIPS 28 (2015) 1171 (why models are trained on their own
//! predictions); Forgione, Piga, Automatica 127 (2021) 109492 (multi-step simulation error); Beintema,
//! Schoukens, Tóth, Automatica 156 (2023) 111210 (past windows as encoders, truncated simulation).

mod band;
mod fields;
mod frame;
pub(crate) mod grid;
mod learner;
mod model;
mod roll;
#[cfg(test)]
mod tests;

pub use fields::{Settings, count, with_shared};
pub use frame::Frame;
pub use learner::{build, restore};

use crate::LearnError;
use burn::module::Module;
use burn::nn::{Initializer, Linear, LinearConfig};
use burn::tensor::{Device, Tensor};
use neural::{NamedTensor, cpu_as_set, named_parameters, with_parameters};
use rand_distr::{Distribution, StandardNormal};
use seed::Seed;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Input of a network.
///
/// The features of a sample are its position (observed in the past, linearly predicted in the block), the
/// input if there is one, both in scaled units, and a flag: 1 for samples of the block, 0 for those of the
/// past.
#[derive(Debug, Clone)]
pub struct Batch {
    /// Tensor of shape windows × (past + block) × features; the samples of the past come first.
    pub tokens: Tensor<3>,
    /// Number of samples in a block.
    pub block: usize,
}

/// Network that corrects linear predictions: a burn module.
pub trait Network: Module {
    /// Returns corrections of shape windows × block, in units of the linear prediction's typical error. The
    /// correction of a sample may depend only on inputs up to that sample.
    fn forward(&self, batch: Batch) -> Tensor<2>;
}

/// Dimensions that a network is built for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sizes {
    /// Number of features of a sample.
    pub features: usize,
    /// Number of samples in past and block together.
    pub length: usize,
    /// Number of samples in a block.
    pub block: usize,
}

/// Architecture: its configuration, read from the section with its name.
pub trait Architecture: Clone + Send + Sync + Serialize + DeserializeOwned + 'static {
    /// Identifier, which is also the name of the section.
    const ID: &'static str;

    /// Network of the architecture.
    type Network: Network;

    /// Builds a network with initial weights drawn from a seed, usually by [`drawn`].
    ///
    /// # Errors
    /// [`LearnError::Backend`] if the tensor library fails.
    fn init(&self, sizes: Sizes, seed: &Seed, device: &Device) -> Result<Self::Network, LearnError>;
}

/// Builds a linear layer of zeros; [`drawn`] fills it.
#[must_use]
pub fn linear(inputs: usize, outputs: usize, device: &Device) -> Linear {
    LinearConfig::new(inputs, outputs).with_initializer(Initializer::Zeros).init(device)
}

/// Fills a module with initial weights.
///
/// Matrices, and kernels of convolutions (outputs, inputs, taps), are normal with variance 1/(inputs · taps)
/// (LeCun, Bottou, Orr, Müller 1998). They are zero if the parameter's name begins with `head`, so that an
/// untrained model is the linear prediction. Vectors keep their values. `own` overrides the initial values of
/// a parameter, by its name and shape.
///
/// # Errors
/// [`LearnError::Backend`] if the tensor library fails.
pub fn drawn<M: Module>(
    module: M,
    seed: &Seed,
    device: &Device,
    own: impl Fn(&NamedTensor) -> Option<Vec<f64>>,
) -> Result<M, LearnError> {
    let mut weights = Vec::new();
    for parameter in named_parameters(&module)? {
        let mut generator = seed.child(&parameter.name).generator();
        let summed = match *parameter.shape.as_slice() {
            [inputs, _] => Some(inputs),
            [_, inputs, taps] => Some(inputs * taps),
            _ => None,
        };
        match summed {
            _ if parameter.name.starts_with("head") => weights.extend(parameter.values),
            _ if let Some(values) = own(&parameter) => weights.extend(values),
            Some(summed) => {
                let spread = (summed as f64).sqrt().recip();
                let draw = |_: &f64| {
                    let standard: f64 = StandardNormal.sample(&mut generator);
                    spread * standard
                };
                weights.extend(parameter.values.iter().map(draw));
            }
            None => weights.extend(parameter.values),
        }
    }
    Ok(with_parameters(module, &weights, device)?)
}

/// Returns the device on which a trained model predicts: the CPU.
pub(crate) fn plain_device() -> Result<Device, LearnError> {
    Ok(cpu_as_set()?)
}
