//! Sequence models: from a window of the past and the input to the future.
//!
//! A model predicts a block of samples at once: the linear prediction (an autoregression's free run) corrected by a
//! network that reads the past, the input over past and block, and the linear prediction itself. Blocks follow one
//! another, each with what was predicted as its past: a free run. Training minimizes the error of free runs of several
//! blocks, its gradient passed back from block to block. Where the network says nothing, the model is the
//! autoregression.
//!
//! A new architecture is one file: a configuration that implements [`Architecture`], a burn module that implements
//! [`Network`], and an [`Entry`](crate::Entry) with [`build`] and [`restore`]. Everything else stands here.
//!
//! Bengio, Vinyals, Jaitly, Shazeer, NeurIPS 28 (2015) 1171 (why models are trained on their own predictions); Forgione,
//! Piga, Automatica 127 (2021) 109492 (multi-step simulation error); Beintema, Schoukens, Tóth, Automatica 156 (2023)
//! 111210 (past windows as encoders, truncated simulation).

mod band;
mod fields;
mod frame;
mod grid;
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

/// Input of a network: `tokens` of shape windows × (past + block) × features, the samples of the past first. The
/// features of a sample are its position (observed in the past, linearly predicted in the block), the input where there is
/// one, both in scaled units, and 1 for samples of the block, 0 for those of the past.
#[derive(Debug, Clone)]
pub struct Batch {
    /// Windows × (past + block) × features.
    pub tokens: Tensor<3>,
    /// Samples of a block.
    pub block: usize,
}

/// A network: a burn module that corrects linear predictions.
pub trait Network: Module {
    /// Corrections of shape windows × block, in units of the linear prediction's typical error. That of a sample may depend
    /// on the inputs up to that sample only.
    fn forward(&self, batch: Batch) -> Tensor<2>;
}

/// Lengths that a network is made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sizes {
    /// Features of a sample.
    pub features: usize,
    /// Samples of past and block.
    pub length: usize,
    /// Samples of a block.
    pub block: usize,
}

/// An architecture: its configuration, read from the section of its name.
pub trait Architecture: Clone + Send + Sync + Serialize + DeserializeOwned + 'static {
    /// Identifier, the name of the section.
    const ID: &'static str;

    /// Its network.
    type Network: Network;

    /// A network with start weights drawn from a seed, by [`drawn`] as a rule.
    ///
    /// # Errors
    /// [`LearnError::Backend`] where the tensor library refuses.
    fn init(&self, sizes: Sizes, seed: &Seed, device: &Device) -> Result<Self::Network, LearnError>;
}

/// A linear layer of zeros; [`drawn`] fills it.
#[must_use]
pub fn linear(inputs: usize, outputs: usize, device: &Device) -> Linear {
    LinearConfig::new(inputs, outputs).with_initializer(Initializer::Zeros).init(device)
}

/// A module filled with start weights: matrices, and kernels of convolutions (outputs, inputs, taps), normal with variance
/// 1/(inputs · taps) (LeCun, Bottou, Orr, Müller 1998), but zero
/// where the parameter's name begins with `head`, so that an untrained model is the linear prediction; vectors stay as
/// they are. `own` gives the values of parameters that begin otherwise, by name and shape.
///
/// # Errors
/// [`LearnError::Backend`] where the tensor library refuses.
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

/// The device that a trained model predicts on: the processor.
pub(crate) fn plain_device() -> Result<Device, LearnError> {
    Ok(cpu_as_set()?)
}
