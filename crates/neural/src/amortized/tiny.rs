//! Smallest network that can learn to read, for tests: its four outputs are linear in the means of s·z and of
//! 1.

use super::bank::Prior;
use super::estimator::{Amortized, Skilled};
use super::training::Training;
use crate::decay::Encoder;
use crate::flat::named_parameters;
use crate::sequence::Sequence;
use burn::module::Module;
use burn::nn::{Initializer, Linear, LinearConfig};
use burn::tensor::{Device, Tensor, TensorData};
use estimator::FitError;
use rand::RngExt;
use seed::Seed;

#[derive(Module, Debug)]
pub(super) struct Tiny {
    head: Linear,
}

impl Encoder for Tiny {
    /// Returns the features s·z and 1.
    fn input(&self, sequences: &[Sequence], device: &Device) -> Tensor<3> {
        let entries = sequences[0].len();
        let pairs = sequences.iter().flat_map(|one| one.times.iter().zip(&one.values));
        let features = pairs.flat_map(|(s, z)| [s * z, 1.0]).collect();
        Tensor::from_data(TensorData::new(features, [sequences.len(), entries, 2]), device)
    }

    fn encode(&self, input: Tensor<3>) -> Tensor<2> {
        self.head.forward(input.mean_dim(1).squeeze_dim::<2>(1))
    }
}

/// Network architecture with weights drawn within ±`scale`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pupil {
    pub(super) scale: f64,
}

impl Skilled for Pupil {
    type Encoder = Tiny;

    fn encoder(&self, says: usize, device: &Device) -> Tiny {
        let head = LinearConfig::new(2, says).with_bias(false).with_initializer(Initializer::Zeros);
        Tiny { head: head.init(device) }
    }

    fn start(&self, encoder: &Tiny, seed: &Seed) -> Result<Vec<f64>, FitError> {
        let mut generator = seed.generator();
        let count = named_parameters(encoder)?.iter().map(|tensor| tensor.values.len()).sum();
        Ok((0..count).map(|_| self.scale * generator.random_range(-1.0..=1.0)).collect())
    }
}

pub(super) fn prior() -> Prior {
    Prior {
        peaks: [10, 400],
        decay: [0.3, 8.0],
        scatter: [0.003, 0.3],
        unevenness: 0.15,
        missing: 0.2,
        bent: 0.3,
        bend: 0.1,
    }
}

pub(super) fn estimator() -> Amortized<Pupil> {
    Amortized {
        network: Pupil { scale: 0.2 },
        prior: prior(),
        training: Training {
            longest_sequence: 24,
            most_looks: 20,
            max_steps: 300,
            batch: 16,
            learning_rate: 0.1,
            calibration: 800,
        },
    }
}
