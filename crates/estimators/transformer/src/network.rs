//! Network: burn's transformer encoder with a linear head.

#![allow(clippy::indexing_slicing, reason = "the closure runs only for an entry")]

use burn::module::Module;
use burn::nn::activation::ActivationConfig;
use burn::nn::transformer::{TransformerEncoder, TransformerEncoderConfig, TransformerEncoderInput};
use burn::nn::{Initializer, Linear, LinearConfig};
use burn::tensor::{Device, Tensor, TensorData};
use estimator::FitError;
use neural::{Encoder, NamedTensor, Sequence, named_parameters};
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

/// Dimensions of a network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Size {
    /// Number of features of an entry, besides its time.
    pub(crate) features: usize,
    pub(crate) layers: usize,
    pub(crate) heads: usize,
    pub(crate) head_width: usize,
    pub(crate) feed_forward_width: usize,
    /// Number of outputs.
    pub(crate) says: usize,
}

/// Number of features of an entry, and of outputs, for a network that is trained on the one envelope it
/// reads.
pub(crate) const FEATURES: usize = 1;
pub(crate) const SAID: usize = 2;

/// Network of burn's transformer encoder over the entries of the sequence, the mean of its outputs, and a
/// linear head.
///
/// The head has no bias, so that every output depends on the input.
#[derive(Module, Debug)]
pub(crate) struct Network {
    embedding: Linear,
    encoder: TransformerEncoder,
    head: Linear,
}

impl Network {
    /// Creates a network of the given size, with all parameters zero except the factors of the layer norms,
    /// which are one.
    ///
    /// The activation is tanh, which is smooth as a quasi-Newton method needs it. burn's error function, and
    /// hence its GELU, has five digits only. There is no dropout: the loss has to be a function of the
    /// parameters.
    pub(crate) fn zeros(size: Size, device: &Device) -> Self {
        let width = size.heads * size.head_width;
        let linear = |inputs, outputs| {
            LinearConfig::new(inputs, outputs).with_bias(false).with_initializer(Initializer::Zeros)
        };
        Self {
            embedding: linear(size.features, width).init(device),
            encoder: TransformerEncoderConfig::new(width, size.feed_forward_width, size.heads, size.layers)
                .with_dropout(0.0)
                .with_activation(ActivationConfig::Tanh)
                .with_initializer(Initializer::Zeros)
                .init(device),
            head: linear(width, size.says).init(device),
        }
    }

    /// Draws start values in the order of the flat list.
    ///
    /// Weights are normal with variance 2/(inputs + outputs) (Glorot, Bengio, AISTATS 2010), times `scale`.
    /// Biases are zero, and factors of the layer norms are one. The head's weights are uniform within
    /// ±1/(2·width); since the layer norm before it gives a vector of length at most √width, the untrained
    /// rate lies in −0.5..0.5.
    pub(crate) fn draw(&self, scale: f64, generator: &mut impl Rng) -> Result<Vec<f64>, FitError> {
        let mut drawn = Vec::new();
        for NamedTensor { name, shape, values } in named_parameters(self)? {
            match *shape.as_slice() {
                [inputs, outputs] if name.starts_with("head") => {
                    let uniform = |_| (generator.random::<f64>() - 0.5) / inputs as f64;
                    drawn.extend((0..inputs * outputs).map(uniform));
                }
                [inputs, outputs] => {
                    let spread = scale * (2.0 / (inputs + outputs) as f64).sqrt();
                    let normal = |_| spread * generator.sample::<f64, _>(StandardNormal);
                    drawn.extend((0..inputs * outputs).map(normal));
                }
                _ => drawn.extend(values),
            }
        }
        Ok(drawn)
    }

    /// Returns the length of an entry's vector, and of the encoding of its time.
    pub(crate) fn width(&self) -> usize {
        self.encoder.d_model
    }
}

/// Returns `width` sines and cosines of a time: the pair k is sin(time·ω), cos(time·ω) with ω =
/// 10,000^(−2k/width). The time is in units of the mean interval, or in other units for the amortized
/// network.
///
/// For peaks at even times this is the published encoding of the position in the sequence; for uneven times
/// it follows the clock.
///
/// Reference: Vaswani et al., NeurIPS 30 (2017), section 3.5.
pub(crate) fn time_encoding(time: f64, width: usize) -> impl Iterator<Item = f64> {
    (0..width).map(move |at| {
        let pair = (at / 2 * 2) as f64;
        let angle = time * 10_000_f64.powf(-pair / width as f64);
        if at % 2 == 0 { angle.sin() } else { angle.cos() }
    })
}

impl Encoder for Network {
    /// Returns z of each entry, then the encoding of its time since the first entry.
    fn input(&self, sequences: &[Sequence], device: &Device) -> Tensor<3> {
        let entries = Sequence::length(sequences);
        let features = |sequence: &Sequence| -> Vec<f64> {
            let interval = sequence.mean_interval();
            let entries = sequence.times.iter().zip(&sequence.values);
            let features = entries.flat_map(|(time, value)| {
                let since = time - sequence.times[0];
                std::iter::once(*value).chain(time_encoding(since / interval, self.width()))
            });
            features.collect()
        };
        let features = sequences.iter().flat_map(features).collect();
        let shape = [sequences.len(), entries, FEATURES + self.width()];
        Tensor::from_data(TensorData::new(features, shape), device)
    }

    fn encode(&self, input: Tensor<3>) -> Tensor<2> {
        let features = input.dims()[2] - self.width();
        let described = input.clone().narrow(2, 0, features);
        let encoding = input.narrow(2, features, self.width());
        let entries = self.embedding.forward(described) + encoding;
        let read = self.encoder.forward(TransformerEncoderInput::new(entries));
        self.head.forward(read.mean_dim(1).squeeze_dim::<2>(1))
    }
}

#[cfg(test)]
mod tests {
    use super::{Network, Size, time_encoding};
    use neural::{Encoder, Sequence, device, values, with_parameters};
    use rand::SeedableRng;
    use rand::rngs::StdRng;

    const SIZE: Size =
        Size { features: 1, layers: 2, heads: 4, head_width: 4, feed_forward_width: 32, says: 2 };

    fn network(seed: u64, scale: f64) -> Network {
        let device = device().unwrap();
        let network = Network::zeros(SIZE, &device);
        let start = network.draw(scale, &mut StdRng::seed_from_u64(seed)).unwrap();
        with_parameters(network, &start, &device).unwrap()
    }

    fn said(network: &Network, sequence: &Sequence) -> Vec<f64> {
        values(network.encode(network.input(std::slice::from_ref(sequence), &device().unwrap()))).unwrap()
    }

    fn sequence() -> Sequence {
        Sequence { times: vec![-1.0, -0.5, 0.4, 1.0], values: vec![1.3, 0.5, -0.6, -1.2] }
    }

    #[test]
    fn the_encoding_is_the_published_one_at_even_times() {
        let encoding: Vec<f64> = time_encoding(3.0, 4).collect();
        let expected = [3_f64.sin(), 3_f64.cos(), 0.03_f64.sin(), 0.03_f64.cos()];
        for (found, expected) in encoding.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
        // The third of these four times is not two mean intervals (2/3 each) after the first.
        let network = network(0, 1.0);
        let input = values(network.input(&[sequence()], &device().unwrap())).unwrap();
        let third = &input[2 * 17..3 * 17];
        assert_eq!(third[0], -0.6);
        assert!((third[1] - (1.4_f64 * 1.5).sin()).abs() < 1e-15, "{}", third[1]);
    }

    #[test]
    fn the_order_of_the_entries_tells_it_nothing() {
        let network = network(3, 1.0);
        let input = network.input(&[sequence()], &device().unwrap());
        let rows = |order: [usize; 4]| {
            let rows = order.iter().map(|&at| input.clone().narrow(1, at, 1)).collect();
            values(network.encode(burn::tensor::Tensor::cat(rows, 1))).unwrap()
        };
        let [sorted, shuffled] = [[0, 1, 2, 3], [2, 0, 3, 1]].map(rows);
        for (one, other) in sorted.iter().zip(&shuffled) {
            assert!((one - other).abs() < 1e-14, "{one} {other}");
        }
        // The assignment of values to times has an effect.
        let swapped = Sequence { values: vec![0.5, 1.3, -0.6, -1.2], ..sequence() };
        assert!((said(&network, &swapped)[0] - sorted[0]).abs() > 1e-6);
    }

    #[test]
    fn entries_attend_to_each_other() {
        // A changed value at one entry changes the network's outputs for the other entries.
        let network = network(3, 1.0);
        let changed = Sequence { values: vec![1.3, 0.5, -0.6, 2.0], ..sequence() };
        let read = |sequence: &Sequence| {
            let input = network.input(std::slice::from_ref(sequence), &device().unwrap());
            let entries = network.embedding.forward(input.clone().narrow(2, 0, 1)) + input.narrow(2, 1, 16);
            let input = burn::nn::transformer::TransformerEncoderInput::new(entries);
            values(network.encoder.forward(input).narrow(1, 0, 1)).unwrap()
        };
        let moved: f64 =
            read(&sequence()).iter().zip(read(&changed)).map(|(one, other)| (one - other).abs()).sum();
        assert!(moved > 1e-3, "{moved:e}");
    }

    #[test]
    fn untrained_it_says_little() {
        for seed in 0..100 {
            let said = said(&network(seed, 10.0), &sequence());
            assert!(said.iter().all(|number| number.abs() <= 0.5), "{said:?}");
        }
    }
}
