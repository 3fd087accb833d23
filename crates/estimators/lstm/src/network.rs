//! Network: burn's LSTM with a linear head.

use crate::backpropagation::Passed;
use burn::module::Module;
use burn::nn::{Initializer, Linear, LinearConfig, Lstm, LstmConfig};
use burn::tensor::{Device, Tensor, TensorData};
use estimator::FitError;
use neural::{Differentiated, Encoder, NamedTensor, Sequence, flat_gradient, named_parameters, tensor};
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

/// Dimensions of a network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Size {
    /// Number of features of an entry of the sequence.
    pub(crate) features: usize,
    /// Number of units of the hidden state, and of the cell.
    pub(crate) units: usize,
    /// Number of outputs.
    pub(crate) says: usize,
}

/// Number of features of an entry, and of outputs, for a network that is trained on the one envelope it
/// reads.
const FEATURES: usize = 2;
const SAID: usize = 2;

/// Network of burn's LSTM and a linear head on its last hidden state.
///
/// The head has no bias, so that every output depends on the input.
#[derive(Module, Debug)]
pub(crate) struct Network {
    lstm: Lstm,
    head: Linear,
}

impl Network {
    /// Creates a network of the given size, with all parameters zero.
    pub(crate) fn zeros(size: Size, device: &Device) -> Self {
        Self {
            lstm: LstmConfig::new(size.features, size.units, true)
                .with_initializer(Initializer::Zeros)
                .init(device),
            head: LinearConfig::new(size.units, size.says)
                .with_bias(false)
                .with_initializer(Initializer::Zeros)
                .init(device),
        }
    }

    /// Creates a network that outputs level and rate of the one envelope it is trained on, with all
    /// parameters zero.
    pub(crate) fn for_one_envelope(units: usize, device: &Device) -> Self {
        Self::zeros(Size { features: FEATURES, units, says: SAID }, device)
    }

    /// Draws start values in the order of the flat list.
    ///
    /// Weights are normal with variance 2/(inputs + outputs) (Glorot, Bengio, AISTATS 2010), times `scale`.
    /// Biases are zero, except one for the forget gate, which therefore starts by remembering (Gers,
    /// Schmidhuber, Cummins, Neural Computation 12 (2000) 2451). The head's weights are uniform within
    /// ±1/(2·hidden units); since no hidden state exceeds 1, the untrained rate lies in −0.5..0.5.
    pub(crate) fn draw(&self, scale: f64, generator: &mut impl Rng) -> Result<Vec<f64>, FitError> {
        let mut drawn = Vec::new();
        for NamedTensor { name, shape, values } in named_parameters(self)? {
            match *shape.as_slice() {
                [inputs, outputs] if name.starts_with("lstm") => {
                    let spread = scale * (2.0 / (inputs + outputs) as f64).sqrt();
                    let normal = |_| spread * generator.sample::<f64, _>(StandardNormal);
                    drawn.extend((0..inputs * outputs).map(normal));
                }
                [inputs, outputs] => {
                    let uniform = |_| (generator.random::<f64>() - 0.5) / inputs as f64;
                    drawn.extend((0..inputs * outputs).map(uniform));
                }
                _ if name == "lstm.forget_gate.input_transform.bias" => {
                    drawn.extend(values.iter().map(|_| 1.0));
                }
                _ => drawn.extend(values),
            }
        }
        Ok(drawn)
    }
}

impl Encoder for Network {
    /// Returns (Δs, z) of each entry: the time since the previous entry in units of the mean interval, 0 for
    /// the first, and z.
    fn input(&self, sequences: &[Sequence], device: &Device) -> Tensor<3> {
        let entries = Sequence::length(sequences);
        let features = |sequence: &Sequence| -> Vec<f64> {
            let interval = sequence.mean_interval();
            let before = sequence.times.first().into_iter().chain(&sequence.times);
            let since = sequence.times.iter().zip(before).map(|(time, before)| (time - before) / interval);
            since.zip(&sequence.values).flat_map(|(since, &value)| [since, value]).collect()
        };
        let features = sequences.iter().flat_map(features).collect();
        Tensor::from_data(TensorData::new(features, [sequences.len(), entries, FEATURES]), device)
    }

    fn encode(&self, input: Tensor<3>) -> Tensor<2> {
        let (_, last) = self.lstm.forward(input, None);
        self.head.forward(last.hidden)
    }

    /// The tape starts at the last hidden state; [`Passed`] handles the recurrence before it, on plain
    /// matrices.
    fn differentiate(
        &self,
        input: Tensor<3>,
        loss: impl FnOnce(Tensor<2>) -> Tensor<1>,
    ) -> Result<Differentiated, FitError> {
        let recording = input.device();
        let [sequences, ..] = input.dims();
        let passed = Passed::forward(&self.lstm, input)?;
        let last = tensor(passed.last(), [sequences, self.lstm.d_hidden], &recording).require_grad();
        let said = self.head.forward(last.clone());
        let loss = loss(said.clone());
        let gradients = loss.backward();
        let none = || FitError::Backend { problem: "no gradient of the last hidden state".to_owned() };
        let mut gradient = passed.backpropagate(last.grad(&gradients).ok_or_else(none)?)?;
        gradient.extend(flat_gradient(&self.head, &gradients)?);
        Ok(Differentiated { said, loss, gradient })
    }
}

#[cfg(test)]
mod tests {
    use super::Network;
    use neural::{Encoder, Sequence, device, named_parameters, values, with_parameters};
    use rand::SeedableRng;
    use rand::rngs::StdRng;

    fn sequence() -> Sequence {
        Sequence { times: vec![-1.0, -0.5, 0.4, 1.0], values: vec![1.3, 0.5, -0.6, -1.2] }
    }

    fn network(units: usize) -> Network {
        let device = device().unwrap();
        let network = Network::for_one_envelope(units, &device);
        let start = network.draw(1.0, &mut StdRng::seed_from_u64(4)).unwrap();
        with_parameters(network, &start, &device).unwrap()
    }

    #[test]
    fn it_reads_the_time_since_the_peak_before() {
        let input = network(3).input(&[sequence()], &device().unwrap());
        // The mean interval is 2/3.
        let expected = [0.0, 1.3, 0.75, 0.5, 1.35, -0.6, 0.9, -1.2];
        for (found, expected) in values(input).unwrap().iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
    }

    /// The equations are i, f, o = σ(W·x + U·h + b), g = tanh(W·x + U·h + b), c = f·c + i·g, h = o·tanh(c):
    /// Hochreiter, Schmidhuber 1997 with the forget gate of Gers et al. 2000. They are computed by hand for
    /// one unit.
    #[test]
    fn it_is_a_long_short_term_memory() {
        let network = network(1);
        let weights = named_parameters(&network).unwrap();
        let weight = |name: &str, at: usize| {
            weights.iter().find(|tensor| tensor.name.ends_with(name)).unwrap().values[at]
        };
        let sigmoid = |x: f64| 1.0 / (1.0 + (-x).exp());
        let features = [[0.0, 1.3], [0.75, 0.5], [1.35, -0.6], [0.9, -1.2]];
        let (mut h, mut c) = (0.0, 0.0);
        for x in features {
            let sum = |gate: &str| {
                let of = |part: &str, at| weight(&format!("{gate}.{part}"), at);
                of("input_transform.weight", 0) * x[0]
                    + of("input_transform.weight", 1) * x[1]
                    + of("input_transform.bias", 0)
                    + of("hidden_transform.weight", 0) * h
                    + of("hidden_transform.bias", 0)
            };
            let (i, f, o) =
                (sigmoid(sum("input_gate")), sigmoid(sum("forget_gate")), sigmoid(sum("output_gate")));
            c = f * c + i * sum("cell_gate").tanh();
            h = o * f64::tanh(c);
        }
        let said = values(network.encode(network.input(&[sequence()], &device().unwrap()))).unwrap();
        for (at, said) in said.iter().enumerate() {
            let expected = weight("head.weight", at) * h;
            assert!((said - expected).abs() < 1e-15, "{said} {expected}");
        }
    }

    #[test]
    fn untrained_it_says_little_and_remembers() {
        for seed in 0..100 {
            let device = device().unwrap();
            let network = Network::for_one_envelope(16, &device);
            let start = network.draw(10.0, &mut StdRng::seed_from_u64(seed)).unwrap();
            let network = with_parameters(network, &start, &device).unwrap();
            let said = values(network.encode(network.input(&[sequence()], &device))).unwrap();
            assert!(said.iter().all(|number| number.abs() < 0.5), "{said:?}");
        }
        for tensor in named_parameters(&network(2)).unwrap() {
            if tensor.name.ends_with("bias") {
                let expected = f64::from(u8::from(tensor.name == "lstm.forget_gate.input_transform.bias"));
                assert_eq!(tensor.values, [expected; 2], "{}", tensor.name);
            }
        }
    }
}
