//! Forward and backward pass of the recurrence, on plain matrices.
//!
//! burn records dozens of small operations for every peak, each with its own tensor. At 69 peaks they took
//! nine tenths of the training time, in the forward pass and on the tape, and the time on the tape grows more
//! than linearly with the length. Here the whole recurrence is one operation: the four gates of a unit are
//! adjacent rows of one matrix, the states of the forward pass are stored, and the adjoint is propagated back
//! over them. The network itself, with its parameters and its file, remains burn's; a test compares both
//! passes with burn's own LSTM and tape.
//!
//! Reference: Werbos, Proceedings of the IEEE 78 (1990) 1550; for the cell with its forget gate Gers,
//! Schmidhuber, Cummins, Neural Computation 12 (2000) 2451.

use burn::nn::{GateController, Lstm};
use burn::tensor::Tensor;
use estimator::FitError;
use nalgebra::DMatrix;
use neural::values;

/// Gates of a unit, in the order of burn's parameters: input, forget, output, candidate.
const GATES: usize = 4;

/// Forward pass with its states. In a matrix with one column per entry, the first entries of all sequences
/// come first, then the second ones, and so on. Its rows are units, or the four gates of the first unit, then
/// of the second, and so on.
pub(crate) struct Passed {
    units: usize,
    sequences: usize,
    /// Input features: features by entries.
    inputs: DMatrix<f64>,
    /// Weights of the gates on the hidden state: gates by units.
    from_hidden: DMatrix<f64>,
    /// Values of the gates, σ(p), and tanh(p) for the candidate: gates by entries.
    gates: DMatrix<f64>,
    /// Hidden states: units by entries, starting with the states before the first entry.
    hidden: DMatrix<f64>,
    /// Cells, in the layout of the hidden states.
    cells: DMatrix<f64>,
}

/// Converts a tensor to a matrix; the tensor's last axis becomes the rows.
fn columns<const D: usize>(tensor: Tensor<D>, rows: usize) -> Result<DMatrix<f64>, FitError> {
    let values = values(tensor)?;
    Ok(DMatrix::from_vec(rows, values.len() / rows.max(1), values))
}

/// Returns the sum of the biases of a gate's two transforms, one per unit.
fn biases(gate: &GateController, units: usize) -> Result<Vec<f64>, FitError> {
    let mut sums = vec![0.0; units];
    for own in [&gate.input_transform.bias, &gate.hidden_transform.bias].into_iter().flatten() {
        sums.iter_mut().zip(values(own.val())?).for_each(|(sum, bias)| *sum += bias);
    }
    Ok(sums)
}

fn sigmoid(x: f64) -> f64 {
    1.0 / (1.0 + (-x).exp())
}

impl Passed {
    /// Runs the forward pass on `inputs` of shape sequences × entries × features.
    ///
    /// # Errors
    /// [`FitError::Backend`] if the LSTM has no forget gate or a tensor does not hold doubles.
    pub(crate) fn forward(lstm: &Lstm, inputs: Tensor<3>) -> Result<Self, FitError> {
        let [sequences, entries, features] = inputs.dims();
        let units = lstm.d_hidden;
        let inputs = columns(inputs.swap_dims(0, 1), features)?;
        let Some(forget) = &lstm.forget_gate else {
            return Err(FitError::Backend { problem: "an LSTM without a forget gate".to_owned() });
        };
        let mut from_input = DMatrix::zeros(GATES * units, features);
        let mut from_hidden = DMatrix::zeros(GATES * units, units);
        let mut gates = DMatrix::zeros(GATES * units, sequences * entries);
        for (at, gate) in [&lstm.input_gate, forget, &lstm.output_gate, &lstm.cell_gate].iter().enumerate() {
            let own = columns(gate.input_transform.weight.val(), units)?;
            from_input.rows_with_step_mut(at, units, GATES - 1).copy_from(&own);
            let own = columns(gate.hidden_transform.weight.val(), units)?;
            from_hidden.rows_with_step_mut(at, units, GATES - 1).copy_from(&own);
            let biases = biases(gate, units)?;
            for mut column in gates.rows_with_step_mut(at, units, GATES - 1).column_iter_mut() {
                column.iter_mut().zip(&biases).for_each(|(sum, bias)| *sum = *bias);
            }
        }
        gates.gemm(1.0, &from_input, &inputs, 1.0);
        // Before the first entry the state is zero.
        let states = DMatrix::zeros(units, sequences * (entries + 1));
        let (hidden, cells) = (states.clone(), states);
        let mut passed = Self { units, sequences, inputs, from_hidden, gates, hidden, cells };
        (0..entries).for_each(|entry| passed.step(entry * sequences));
        Ok(passed)
    }

    /// Computes c = f·c₋ + i·g, h = o·tanh c for the entries in the columns from `first` on.
    fn step(&mut self, first: usize) {
        let mut sums = self.gates.columns_mut(first, self.sequences);
        sums.gemm(1.0, &self.from_hidden, &self.hidden.columns(first, self.sequences), 1.0);
        for (at, mut column) in (first..).zip(sums.column_iter_mut()) {
            let (before, mut after) = self.cells.columns_range_pair_mut(at, at + self.sequences);
            let mut hidden = self.hidden.column_mut(at + self.sequences);
            let states = before.iter().zip(after.iter_mut()).zip(hidden.iter_mut());
            let (units, _) = column.as_mut_slice().as_chunks_mut::<GATES>();
            for ([input, forget, output, candidate], ((before, cell), hidden)) in units.iter_mut().zip(states)
            {
                *input = sigmoid(*input);
                *forget = sigmoid(*forget);
                *output = sigmoid(*output);
                *candidate = candidate.tanh();
                *cell = *forget * before + *input * *candidate;
                *hidden = *output * cell.tanh();
            }
        }
    }

    /// Returns the last hidden states, sequence by sequence.
    pub(crate) fn last(&self) -> Vec<f64> {
        let first = self.hidden.ncols() - self.sequences;
        self.hidden.columns(first, self.sequences).iter().copied().collect()
    }

    /// Returns the derivatives of a result with respect to the LSTM's parameters, in the order of the flat
    /// list. `by_last`, sequences × units, are the derivatives of the result with respect to the last hidden
    /// states. With δ the adjoints,
    ///
    /// δc = δc₊·f₊ + δh·o·(1 − tanh²c), δh = Σ Uᵀδp₊.
    ///
    /// # Errors
    /// [`FitError::Backend`] if the tensor does not hold doubles.
    pub(crate) fn backpropagate(&self, by_last: Tensor<2>) -> Result<Vec<f64>, FitError> {
        let (units, sequences) = (self.units, self.sequences);
        let mut by_hidden = columns(by_last, units)?;
        let mut by_cell = DMatrix::<f64>::zeros(units, sequences);
        let mut adjoint = DMatrix::<f64>::zeros(GATES * units, self.gates.ncols());
        for entry in (0..self.gates.ncols() / sequences.max(1)).rev() {
            let first = entry * sequences;
            for at in 0..sequences {
                let (gates, mut own) = (self.gates.column(first + at), adjoint.column_mut(first + at));
                let cells = self.cells.column(first + at);
                let cells = cells.iter().zip(self.cells.column(first + at + sequences));
                let mut by_cell = by_cell.column_mut(at);
                let by_state = by_hidden.column(at);
                let by_state = by_state.iter().zip(by_cell.iter_mut());
                let gates = gates.as_slice().as_chunks::<GATES>().0.iter();
                let own = own.as_mut_slice().as_chunks_mut::<GATES>().0.iter_mut();
                for ((gate, by_sum), ((before, cell), (by_hidden, by_cell))) in
                    gates.zip(own).zip(cells.zip(by_state))
                {
                    (*by_sum, *by_cell) = back(*gate, [*before, *cell], *by_hidden, *by_cell);
                }
            }
            by_hidden.gemm_tr(1.0, &self.from_hidden, &adjoint.columns(first, sequences), 0.0);
        }
        Ok(self.gradient(&adjoint))
    }

    /// Returns the gradient gate by gate: the input's weights and biases, then those of the hidden state.
    fn gradient(&self, adjoint: &DMatrix<f64>) -> Vec<f64> {
        let by_inputs = adjoint * self.inputs.transpose();
        let by_hidden = adjoint * self.hidden.columns(0, adjoint.ncols()).transpose();
        let by_biases = adjoint.column_sum();
        let mut flat = Vec::new();
        for at in 0..GATES {
            let biases = by_biases.rows_with_step(at, self.units, GATES - 1);
            for weights in [&by_inputs, &by_hidden] {
                flat.extend(weights.rows_with_step(at, self.units, GATES - 1).iter().copied());
                flat.extend(biases.iter().copied());
            }
        }
        flat
    }
}

/// Returns the adjoints of a unit's sums, and of its cell one entry earlier, from those of its hidden state
/// and its cell.
fn back(
    [input, forget, output, candidate]: [f64; GATES],
    [before, cell]: [f64; 2],
    by_hidden: f64,
    by_cell: f64,
) -> ([f64; GATES], f64) {
    let squashed = cell.tanh();
    let by_cell = by_cell + by_hidden * output * (1.0 - squashed * squashed);
    let by_sums = [
        by_cell * candidate * input * (1.0 - input),
        by_cell * before * forget * (1.0 - forget),
        by_hidden * squashed * output * (1.0 - output),
        by_cell * input * (1.0 - candidate * candidate),
    ];
    (by_sums, by_cell * forget)
}

#[cfg(test)]
mod tests {
    use crate::network::{Network, Size};
    use burn::tensor::{Tensor, TensorData};
    use neural::{Encoder, device, flat_gradient, values, with_parameters};
    use rand::SeedableRng;
    use rand::rngs::StdRng;

    #[test]
    fn it_gives_the_gradient_of_the_tape() {
        let recording = device().unwrap().autodiff();
        for (sequences, entries, units) in [(1, 1, 3), (1, 7, 1), (1, 40, 5), (2, 1, 1), (3, 8, 4)] {
            let network = Network::zeros(Size { features: 2, units, says: 2 }, &device().unwrap());
            // All parameters differ, including the biases.
            let start = network.draw(1.0, &mut StdRng::seed_from_u64(8)).unwrap();
            let start: Vec<f64> =
                start.iter().enumerate().map(|(at, x)| x + 0.3 * (at as f64).sin()).collect();
            let network = with_parameters(network, &start, &recording).unwrap();
            let count = 2 * sequences * entries;
            let features = (0..count).map(|at| (1.7 * at as f64).cos()).collect::<Vec<f64>>();
            let shape = [sequences, entries, 2];
            let input: Tensor<3> = Tensor::from_data(TensorData::new(features, shape), &recording);
            let loss = |said: Tensor<2>| (said.clone() * said.clone() + said * 3.0).sum();

            let said = network.encode(input.clone());
            let expected = loss(said.clone());
            let by_tape = flat_gradient(&network, &expected.backward()).unwrap();
            let found = network.differentiate(input, loss).unwrap();
            let [found_said, said] = [found.said, said].map(|said| values(said).unwrap());
            for (found, expected) in found_said.iter().zip(&said) {
                assert!((found - expected).abs() < 1e-14, "{found} {expected}");
            }
            let [found_loss, expected] = [found.loss, expected].map(|loss| values(loss).unwrap()[0]);
            assert!((found_loss / expected - 1.0).abs() < 1e-13, "{found_loss} {expected}");
            assert_eq!(found.gradient.len(), by_tape.len());
            let largest = by_tape.iter().copied().fold(0.0, |one: f64, other| one.max(other.abs()));
            for (at, (found, expected)) in found.gradient.iter().zip(&by_tape).enumerate() {
                assert!((found - expected).abs() < 1e-14 * largest, "{at}: {found} {expected}");
            }
            assert!(largest > 1e-2, "{largest}");
        }
    }
}
