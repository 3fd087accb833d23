//! Diagonal state-space layers that correct linear predictions.
//!
//! Every channel has its own linear state space, diagonal with complex eigenvalues; its impulse response k(j)
//! = Σ |λ|ʲ·(a·cos jω − b·sin jω) is convolved with the channel. A gated linear layer mixes the channels.
//!
//! Gu, Goel, Gupta, Ré, NeurIPS 35 (2022), "On the parameterization and initialization of diagonal state
//! space models" (S4D: one diagonal system for each channel, applied as a convolution); Orvieto et al., ICML
//! 2023 (LRU: eigenvalues exp(−exp ν + i·exp φ), normalization √(1 − |λ|²)).

use crate::sequence::{
    Architecture, Batch, Network, Sizes, build, count, drawn, linear, restore, with_shared,
};
use crate::{Entry, Kind, LearnError};
use burn::module::{Module, Param};
use burn::nn::{Initializer, Linear};
use burn::tensor::activation::sigmoid;
use burn::tensor::{Device, Int, Tensor, TensorData};
use neural::NamedTensor;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use seed::Seed;
use serde::{Deserialize, Serialize};
use settings::Field;
use std::f64::consts::PI;

/// Entry in the registry.
pub const ENTRY: Entry = Entry {
    id: StateSpace::ID,
    title: "State-space layers on a linear prediction",
    summary: "Reads past and input with diagonal state-space layers and corrects a linear prediction, block by block.",
    reference: "Gu, Goel, Gupta, Ré, NeurIPS 35 (2022) 35971-35983",
    kind: Kind::Sequence,
    fields: &FIELDS,
    build: build::<StateSpace>,
    restore: restore::<StateSpace>,
};

const FIELDS: [Field; 15] = with_shared([
    count("channels", [1, 1_024], 16, "Channels of every layer, each with a state space of its own."),
    count("states", [1, 1_024], 6, "Complex states of a channel."),
    count("layers", [1, 64], 2, "Layers, one after the other."),
]);

/// Settings of the architecture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StateSpace {
    channels: usize,
    states: usize,
    layers: usize,
}

/// One layer: eigenvalues and output weights of shape channels × states each, a direct path, and gated
/// mixing.
#[derive(Module, Debug)]
pub struct Layer {
    log_decay: Param<Tensor<2>>,
    log_frequency: Param<Tensor<2>>,
    real: Param<Tensor<2>>,
    imaginary: Param<Tensor<2>>,
    direct: Param<Tensor<1>>,
    mix: Linear,
}

/// Layers between an embedding and a linear head.
#[derive(Module, Debug)]
pub struct Layers {
    embedding: Linear,
    layers: Vec<Layer>,
    head: Linear,
}

/// Fastest and slowest initial decay rate, per sample: moduli of the eigenvalues from 0.5 to 0.99.
const DECAYS: [f64; 2] = [0.7, 0.01];

impl Architecture for StateSpace {
    const ID: &'static str = "state-space";
    type Network = Layers;

    fn init(&self, sizes: Sizes, seed: &Seed, device: &Device) -> Result<Layers, LearnError> {
        let shape = [self.channels, self.states];
        let layer = |_| Layer {
            log_decay: Initializer::Zeros.init(shape, device),
            log_frequency: Initializer::Zeros.init(shape, device),
            real: Initializer::Zeros.init(shape, device),
            imaginary: Initializer::Zeros.init(shape, device),
            direct: Initializer::Ones.init([self.channels], device),
            mix: linear(self.channels, 2 * self.channels, device),
        };
        let network = Layers {
            embedding: linear(sizes.features, self.channels, device),
            layers: (0..self.layers).map(layer).collect(),
            head: linear(self.channels, 1, device),
        };
        drawn(network, seed, device, |own| self.spread(own, seed))
    }
}

impl StateSpace {
    /// Draws initial values of a layer's state-space parameters: decay rates uniform in their logarithm,
    /// frequencies up to about a third of half the sampling rate, output weights normal. `None` for other
    /// parameters.
    fn spread(&self, own: &NamedTensor, seed: &Seed) -> Option<Vec<f64>> {
        let mut generator = seed.child("state spaces").child(&own.name).generator();
        let count = own.values.len();
        let [fast, slow] = DECAYS.map(f64::ln);
        let mut each = |draw: &mut dyn FnMut(f64, f64) -> f64| -> Vec<f64> {
            let mut one = || (generator.random::<f64>(), StandardNormal.sample(&mut generator));
            (0..count).map(|_| one()).map(|(uniform, normal)| draw(uniform, normal)).collect()
        };
        match own.name.rsplit('.').next() {
            Some("log_decay") => Some(each(&mut |uniform, _| fast + uniform * (slow - fast))),
            Some("log_frequency") => Some(each(&mut |uniform, _| (PI / 3.0 * (0.02 + uniform)).ln())),
            Some("real" | "imaginary") => {
                let size = (self.states as f64).sqrt().recip();
                Some(each(&mut |_, normal| size * normal))
            }
            _ => None,
        }
    }
}

impl Layer {
    /// Returns the impulse responses, channels × length.
    fn responses(&self, length: usize, device: &Device) -> Tensor<2> {
        let steps: Vec<f64> = (0..length).map(|step| step as f64).collect();
        let steps = Tensor::<3>::from_data(TensorData::new(steps, [1, 1, length]), device);
        let decay = self.log_decay.val().exp();
        let size = (decay.clone() * -2.0).exp().neg().add_scalar(1.0).sqrt();
        let falling = (decay.neg().unsqueeze_dim::<3>(2) * steps.clone()).exp();
        let phase = self.log_frequency.val().exp().unsqueeze_dim::<3>(2) * steps;
        let weight = |own: &Param<Tensor<2>>| (own.val() * size.clone()).unsqueeze_dim::<3>(2);
        let turning = weight(&self.real) * phase.clone().cos() - weight(&self.imaginary) * phase.sin();
        (falling * turning).sum_dim(1).squeeze_dim::<2>(1)
    }

    /// Convolves along the samples: each channel times the triangular matrix of its impulse response.
    fn convolved(&self, samples: &Tensor<3>) -> Tensor<3> {
        let [_, length, channels] = samples.dims();
        let device = samples.device();
        let padded =
            Tensor::cat(vec![self.responses(length, &device), Tensor::zeros([channels, 1], &device)], 1);
        // Entry (from, to) is the response after to − from samples, and zero for negative lags.
        let lags = (0..length)
            .flat_map(|from| (0..length).map(move |to| to.checked_sub(from).unwrap_or(length) as i64));
        let lags = Tensor::<1, Int>::from_data(
            TensorData::new(lags.collect::<Vec<i64>>(), [length * length]),
            &device,
        );
        let matrices = padded.select(1, lags).reshape([channels, length, length]);
        let by_channel = samples.clone().permute([2, 0, 1]);
        by_channel.matmul(matrices).permute([1, 2, 0])
    }

    fn forward(&self, samples: Tensor<3>) -> Tensor<3> {
        let channels = samples.dims()[2];
        let direct = self.direct.val().reshape([1, 1, channels]);
        let read = self.convolved(&samples) + samples.clone() * direct;
        let mixed = self.mix.forward(read.tanh());
        samples + mixed.clone().narrow(2, 0, channels) * sigmoid(mixed.narrow(2, channels, channels))
    }
}

impl Network for Layers {
    fn forward(&self, Batch { tokens, block }: Batch) -> Tensor<2> {
        let length = tokens.dims()[1];
        let mut samples = self.embedding.forward(tokens);
        for layer in &self.layers {
            samples = layer.forward(samples);
        }
        self.head.forward(samples.narrow(1, length - block, block)).squeeze_dim::<2>(2)
    }
}
