//! Causal dilated convolutions that correct linear predictions.
//!
//! Each layer reads three samples, spaced twice as far apart as in the previous layer, and adds its result to
//! its input.
//!
//! Bai, Kolter, Koltun, arXiv:1803.01271 (2018); Andersson, Ribeiro, Tiels, Wahlström, Schön, CDC 2019
//! (system identification).

use crate::sequence::{
    Architecture, Batch, Network, Sizes, build, count, drawn, linear, restore, with_shared,
};
use crate::{Entry, Kind, LearnError};
use burn::module::Module;
use burn::nn::Linear;
use burn::tensor::{Device, Tensor};
use seed::Seed;
use serde::{Deserialize, Serialize};
use settings::Field;

/// Entry in the registry.
pub const ENTRY: Entry = Entry {
    id: TemporalConvolution::ID,
    title: "Temporal convolution on a linear prediction",
    summary: "Reads past and input with causal dilated convolutions and corrects a linear prediction, block by block.",
    reference: "Bai, Kolter, Koltun, arXiv:1803.01271 (2018)",
    kind: Kind::Sequence,
    fields: &FIELDS,
    build: build::<TemporalConvolution>,
    restore: restore::<TemporalConvolution>,
};

const FIELDS: [Field; 14] = with_shared([
    count("channels", [1, 4_096], 16, "Channels of every layer."),
    count(
        "layers",
        [1, 16],
        5,
        "Layers, the dilation of each twice that of the one before: five of them see 62 samples back.",
    ),
]);

/// Settings of the architecture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TemporalConvolution {
    channels: usize,
    layers: usize,
}

/// Number of samples that a layer reads.
const TAPS: usize = 3;

/// Layers with three taps each, and a linear head.
#[derive(Module, Debug)]
pub struct Convolutions {
    embedding: Linear,
    layers: Vec<Linear>,
    head: Linear,
}

impl Architecture for TemporalConvolution {
    const ID: &'static str = "temporal-convolution";
    type Network = Convolutions;

    fn init(&self, sizes: Sizes, seed: &Seed, device: &Device) -> Result<Convolutions, LearnError> {
        let layer = |_| linear(TAPS * self.channels, self.channels, device);
        let network = Convolutions {
            embedding: linear(sizes.features, self.channels, device),
            layers: (0..self.layers).map(layer).collect(),
            head: linear(self.channels, 1, device),
        };
        drawn(network, seed, device, |_| None)
    }
}

/// Delays samples by `by` places and fills the start with zeros.
fn delayed(samples: &Tensor<3>, by: usize) -> Tensor<3> {
    let [windows, length, channels] = samples.dims();
    let by = by.min(length);
    let zeros = Tensor::zeros([windows, by, channels], &samples.device());
    if by == length {
        return zeros;
    }
    Tensor::cat(vec![zeros, samples.clone().narrow(1, 0, length - by)], 1)
}

impl Network for Convolutions {
    fn forward(&self, Batch { tokens, block }: Batch) -> Tensor<2> {
        let length = tokens.dims()[1];
        let mut samples = self.embedding.forward(tokens);
        let mut dilation = 1;
        for layer in &self.layers {
            let taps = (0..TAPS).map(|tap| delayed(&samples, tap * dilation)).collect();
            samples = samples + layer.forward(Tensor::cat(taps, 2)).tanh();
            dilation *= 2;
        }
        self.head.forward(samples.narrow(1, length - block, block)).squeeze_dim::<2>(2)
    }
}
