//! Transformer that corrects linear predictions.
//!
//! Every sample of past and block attends to itself and to earlier samples; corrections are read from the
//! samples of the block.
//!
//! Vaswani et al., NeurIPS 30 (2017); Xiong et al., ICML 2020 (norms before the layers).

use crate::sequence::{
    Architecture, Batch, Network, Sizes, build, count, drawn, linear, restore, with_shared,
};
use crate::{Entry, Kind, LearnError};
use burn::module::{Module, Param};
use burn::nn::activation::ActivationConfig;
use burn::nn::transformer::{TransformerEncoder, TransformerEncoderConfig, TransformerEncoderInput};
use burn::nn::{Initializer, Linear};
use burn::tensor::{Bool, Device, Tensor};
use seed::Seed;
use serde::{Deserialize, Serialize};
use settings::Field;

/// Entry in the registry.
pub const ENTRY: Entry = Entry {
    id: Transformer::ID,
    title: "Transformer on a linear prediction",
    summary: "Attends to past and input and corrects a linear prediction, block by block.",
    reference: "Vaswani et al., NeurIPS 30 (2017) 5998-6008",
    kind: Kind::Sequence,
    fields: &FIELDS,
    build: build::<Transformer>,
    restore: restore::<Transformer>,
};

const FIELDS: [Field; 15] = with_shared([
    count("layers", [1, 64], 2, "Layers of attention."),
    count("heads", [1, 64], 2, "Heads of each layer."),
    count(
        "head_width",
        [1, 1_024],
        8,
        "Numbers that a head compares; a sample is described by heads × head_width of them.",
    ),
]);

/// Settings of the architecture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Transformer {
    layers: usize,
    heads: usize,
    head_width: usize,
}

/// burn's encoder on embedded samples with a learned position vector, and a linear head.
#[derive(Module, Debug)]
pub struct Attention {
    embedding: Linear,
    places: Param<Tensor<2>>,
    encoder: TransformerEncoder,
    head: Linear,
}

impl Architecture for Transformer {
    const ID: &'static str = "transformer";
    type Network = Attention;

    fn init(&self, sizes: Sizes, seed: &Seed, device: &Device) -> Result<Attention, LearnError> {
        let width = self.heads * self.head_width;
        let network = Attention {
            embedding: linear(sizes.features, width, device),
            places: Initializer::Zeros.init([sizes.length, width], device),
            encoder: TransformerEncoderConfig::new(width, 2 * width, self.heads, self.layers)
                .with_dropout(0.0)
                .with_norm_first(true)
                .with_activation(ActivationConfig::Tanh)
                .with_initializer(Initializer::Zeros)
                .init(device),
            head: linear(width, 1, device),
        };
        drawn(network, seed, device, |_| None)
    }
}

impl Network for Attention {
    fn forward(&self, Batch { tokens, block }: Batch) -> Tensor<2> {
        let [windows, length, _] = tokens.dims();
        let device = tokens.device();
        let described = self.embedding.forward(tokens) + self.places.val().unsqueeze_dim::<3>(0);
        // The mask is true where attention is blocked: at later samples.
        let later = Tensor::<2, Bool>::tril_mask([length, length], 0, &device).unsqueeze_dim::<3>(0);
        let later = later.repeat_dim(0, windows);
        let read = self.encoder.forward(TransformerEncoderInput::new(described).mask_attn(later));
        self.head.forward(read.narrow(1, length - block, block)).squeeze_dim::<2>(2)
    }
}
