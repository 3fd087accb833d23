//! Reading of a sequence forward and backward.
//!
//! Read backward, an envelope grows as fast as it decays. The network need not learn this symmetry: it reads
//! both ways, and the answer is the mean. A curve that bends symmetrically about its middle then has a rate
//! of exactly zero.

use crate::sequence::Sequence;
use burn::tensor::Tensor;

/// Number of network outputs per sequence: level, rate, and the logarithms of their variances multiplied by
/// the number of entries.
pub(super) const SAID: usize = 4;

/// Returns the sequences, followed by each of them reversed.
pub(super) fn both_ways<'a>(sequences: impl Iterator<Item = &'a Sequence> + Clone) -> Vec<Sequence> {
    sequences.clone().cloned().chain(sequences.map(backward)).collect()
}

fn backward(sequence: &Sequence) -> Sequence {
    Sequence {
        times: sequence.times.iter().rev().map(|time| -time).collect(),
        values: sequence.values.iter().rev().copied().collect(),
    }
}

/// Combines the outputs for sequences read [`both_ways`] into one output per sequence: the mean, with the
/// sign of the backward rate changed.
pub(super) fn agreed(said: Tensor<2>) -> Tensor<2> {
    let sequences = said.dims()[0] / 2;
    let forward = said.clone().narrow(0, 0, sequences);
    let backward = said.narrow(0, sequences, sequences);
    let rate = forward.clone().narrow(1, 1, 1) - backward.clone().narrow(1, 1, 1);
    let sum = forward + backward;
    let (level, variances) = (sum.clone().narrow(1, 0, 1), sum.narrow(1, 2, SAID - 2));
    Tensor::cat(vec![level, rate, variances], 1) / 2.0
}

#[cfg(test)]
mod tests {
    use super::{agreed, both_ways};
    use crate::device::{device, tensor, values};
    use crate::sequence::Sequence;

    #[test]
    fn backward_is_the_same_line_growing() {
        // z = 1 − 2s and its mirror image 1 + 2s.
        let sequence = Sequence { times: vec![-1.0, 0.5, 1.0], values: vec![3.0, 0.0, -1.0] };
        let [forward, backward] = both_ways([&sequence].into_iter()).try_into().unwrap();
        assert_eq!(forward, sequence);
        assert_eq!(backward, Sequence { times: vec![-1.0, -0.5, 1.0], values: vec![-1.0, 0.0, 3.0] });
        // Outputs for two sequences, in the order forward, forward, backward, backward.
        let said = vec![1.0, 2.0, 3.0, 4.0, 0.0, 0.0, 0.0, 0.0, 1.0, -4.0, 5.0, 4.0, 0.0, 0.0, 0.0, 6.0];
        let agreed = agreed(tensor(said, [4, 4], &device().unwrap()));
        assert_eq!(values(agreed).unwrap(), [1.0, 3.0, 4.0, 4.0, 0.0, 0.0, 0.0, 3.0]);
    }
}
