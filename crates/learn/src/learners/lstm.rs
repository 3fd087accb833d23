//! Long short-term memory network that corrects linear predictions.
//!
//! It reads the past sample by sample, then the inputs and linear predictions of the block, and outputs a
//! correction for each sample of the block.
//!
//! Hochreiter, Schmidhuber, Neural Computation 9 (1997) 1735; Gers, Schmidhuber, Cummins, Neural Computation
//! 12 (2000) 2451 (forget gate).

use crate::sequence::{
    Architecture, Batch, Network, Sizes, build, count, drawn, linear, restore, with_shared,
};
use crate::{Entry, Kind, LearnError};
use burn::module::Module;
use burn::nn::Linear;
use burn::tensor::activation::sigmoid;
use burn::tensor::{Device, Tensor};
use seed::Seed;
use serde::{Deserialize, Serialize};
use settings::Field;

/// Entry in the registry.
pub const ENTRY: Entry = Entry {
    id: Lstm::ID,
    title: "LSTM on a linear prediction",
    summary: "Reads past and input with a long short-term memory and corrects a linear prediction, block by block.",
    reference: "Hochreiter, Schmidhuber, Neural Computation 9 (1997) 1735-1780",
    kind: Kind::Sequence,
    fields: &FIELDS,
    build: build::<Lstm>,
    restore: restore::<Lstm>,
};

const FIELDS: [Field; 13] =
    with_shared([count("units", [1, 4_096], 24, "Units of the hidden state, and of the cell.")]);

/// Settings of the architecture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Lstm {
    units: usize,
}

/// One LSTM layer and a linear head. The gates are concatenated in the order input, forget, output, cell.
#[derive(Module, Debug)]
pub struct Memory {
    from_input: Linear,
    from_hidden: Linear,
    head: Linear,
}

impl Architecture for Lstm {
    const ID: &'static str = "lstm";
    type Network = Memory;

    fn init(&self, sizes: Sizes, seed: &Seed, device: &Device) -> Result<Memory, LearnError> {
        let units = self.units;
        let network = Memory {
            from_input: linear(sizes.features, 4 * units, device),
            from_hidden: linear(units, 4 * units, device),
            head: linear(units, 1, device),
        };
        // With its forget gate open at the start, the network remembers.
        let forget = |at: usize| if (units..2 * units).contains(&at) { 1.0 } else { 0.0 };
        drawn(network, seed, device, |own| {
            (own.name == "from_input.bias").then(|| (0..4 * units).map(forget).collect())
        })
    }
}

impl Network for Memory {
    fn forward(&self, Batch { tokens, block }: Batch) -> Tensor<2> {
        let [windows, length, _] = tokens.dims();
        let device = tokens.device();
        let read = self.from_input.forward(tokens);
        let units = read.dims()[2] / 4;
        let mut hidden: Tensor<2> = Tensor::zeros([windows, units], &device);
        let mut cell = hidden.clone();
        let mut kept = Vec::new();
        for at in 0..length {
            let sums = read.clone().narrow(1, at, 1).squeeze_dim::<2>(1) + self.from_hidden.forward(hidden);
            let gates = sigmoid(sums.clone().narrow(1, 0, 3 * units));
            let gate = |number: usize| gates.clone().narrow(1, number * units, units);
            cell = gate(1) * cell + gate(0) * sums.narrow(1, 3 * units, units).tanh();
            hidden = gate(2) * cell.clone().tanh();
            if at + block >= length {
                kept.push(hidden.clone());
            }
        }
        self.head.forward(Tensor::<2>::stack::<3>(kept, 1)).squeeze_dim::<2>(2)
    }
}
