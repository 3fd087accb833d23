//! Amortized network: trained on simulated envelopes, applied to measured ones.

use crate::config::{HIDDEN_UNITS, INITIAL_SCALE};
use crate::network::{Network, Size};
use burn::module::Module;
use burn::tensor::{Device, Tensor, TensorData};
use estimator::{Entry, Estimator, FitError, Tag};
use neural::amortized::{Amortized, Skilled, fields};
use neural::{Differentiated, Encoder, Sequence};
use seed::Seed;
use serde::Deserialize;
use settings::Field;

/// Settings of the network; those of its training are [`neural::amortized::fields`].
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct AmortizedLstmConfig {
    /// Number of units of the hidden state, and of the cell.
    pub hidden_units: usize,
    /// Factor on the random start values of the gates' weights.
    pub initial_scale: f64,
}

/// Configuration keys.
const FIELDS: &[Field] = &[
    HIDDEN_UNITS.source("within 4 % of least squares over fresh envelopes; 24 are no nearer"),
    fields::LONGEST_SEQUENCE,
    fields::MOST_LOOKS,
    fields::MAX_STEPS,
    fields::BATCH,
    fields::LEARNING_RATE,
    fields::CALIBRATION,
    INITIAL_SCALE,
    fields::PEAKS,
    fields::DECAY,
    fields::SCATTER,
    fields::UNEVENNESS,
    fields::MISSING,
    fields::BENT,
    fields::BEND,
];

/// Registry entry of the network that is trained on simulated envelopes.
pub const AMORTIZED_ENTRY: Entry = Entry {
    id: "lstm-amortized",
    paper_number: None,
    title: "Long short-term memory network, amortized",
    summary: "Trained only on simulated envelopes; reads a new envelope peak by peak.",
    tags: &[Tag::Amortized, Tag::Iterative, Tag::Seeded, Tag::Interval, Tag::Ablation],
    citations: &[
        "Hochreiter, Schmidhuber, Neural Computation 9 (1997) 1735-1780",
        "Cranmer, Brehmer, Louppe, PNAS 117 (2020) 30055-30062",
        "Putzky, Welling, arXiv:1706.04008 (2017)",
        "Kingma, Ba, International Conference on Learning Representations (2015)",
    ],
    fields: FIELDS,
    build: |settings| {
        let network: AmortizedLstmConfig = settings.section("estimator")?;
        Ok(Box::new(Amortized::new(network, settings)?) as Box<dyn Estimator>)
    },
};

/// Network of [`ENTRY`](crate::ENTRY) whose input includes the position in the record.
///
/// A network trained on one envelope may learn the number of peaks; here the input has to contain it.
#[derive(Module, Debug)]
pub struct Reader {
    network: Network,
}

/// Number of features of an entry.
const FEATURES: usize = 4;

impl Encoder for Reader {
    /// Returns (s, ln Δ, z, Δz) of each entry: its time, the logarithm of the mean time between entries, its
    /// value, and the change of the value since the previous entry, which distinguishes scatter from a bend.
    fn input(&self, sequences: &[Sequence], device: &Device) -> Tensor<3> {
        let entries = Sequence::length(sequences);
        let features = sequences
            .iter()
            .flat_map(|sequence| {
                let interval = sequence.mean_interval().ln();
                let before = sequence.values.first().into_iter().chain(&sequence.values);
                let entries = sequence.times.iter().zip(&sequence.values).zip(before);
                entries.flat_map(move |((&time, &value), before)| [time, interval, value, value - before])
            })
            .collect();
        Tensor::from_data(TensorData::new(features, [sequences.len(), entries, FEATURES]), device)
    }

    fn encode(&self, input: Tensor<3>) -> Tensor<2> {
        self.network.encode(input)
    }

    fn differentiate(
        &self,
        input: Tensor<3>,
        loss: impl FnOnce(Tensor<2>) -> Tensor<1>,
    ) -> Result<Differentiated, FitError> {
        self.network.differentiate(input, loss)
    }
}

impl Skilled for AmortizedLstmConfig {
    type Encoder = Reader;

    fn encoder(&self, says: usize, device: &Device) -> Reader {
        let size = Size { features: FEATURES, units: self.hidden_units, says };
        Reader { network: Network::zeros(size, device) }
    }

    fn start(&self, encoder: &Reader, seed: &Seed) -> Result<Vec<f64>, FitError> {
        encoder.network.draw(self.initial_scale, &mut seed.generator())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use neural::{device, values};

    fn config() -> AmortizedLstmConfig {
        AmortizedLstmConfig { hidden_units: 5, initial_scale: 1.0 }
    }

    #[test]
    fn it_reads_where_it_is_and_what_has_changed() {
        let device = device().unwrap();
        let reader = config().encoder(4, &device);
        let sequence = Sequence { times: vec![-1.0, -0.5, 1.0], values: vec![1.2, 0.0, -1.2] };
        let input = reader.input(&[sequence.clone(), sequence], &device);
        assert_eq!(input.dims(), [2, 3, 4]);
        // The mean interval is 1.
        let expected = [-1.0, 0.0, 1.2, 0.0, -0.5, 0.0, 0.0, -1.2, 1.0, 0.0, -1.2, -1.2];
        assert_eq!(values(input).unwrap(), [expected, expected].concat());
    }
}
