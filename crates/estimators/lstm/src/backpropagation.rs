//! Backpropagation through time.
//!
//! burn's tape keeps dozens of small operations for every peak; at 69 peaks nine tenths of the time go
//! into keeping it, and it grows more than linearly with the length. Here the whole recurrence is one
//! operation: burn's LSTM goes forward, and the adjoint goes back over the states it gave.
//!
//! Reference: Werbos, Proceedings of the IEEE 78 (1990) 1550; for the cell with its forget gate Gers,
//! Schmidhuber, Cummins, Neural Computation 12 (2000) 2451.

use burn::nn::{GateController, Lstm};
use burn::tensor::Tensor;
use estimator::FitError;
use nalgebra::{DMatrix, DVector};
use neural::values;

/// A gate at all times: its weights, and what it let through. A matrix of units by entries holds the first
/// entries of all sequences, then the second ones, and so on.
struct Gate {
    /// Units by units.
    from_hidden: DMatrix<f64>,
    /// Its values σ(p) or tanh(p), units by entries.
    values: DMatrix<f64>,
    /// The result's derivatives with respect to the sums p, units by entries.
    adjoint: DMatrix<f64>,
}

/// A tensor whose last axis are the rows.
fn columns<const D: usize>(tensor: Tensor<D>, rows: usize) -> Result<DMatrix<f64>, FitError> {
    let values = values(tensor)?;
    Ok(DMatrix::from_vec(rows, values.len() / rows, values))
}

impl Gate {
    /// The gate's values, from the inputs and from the hidden states one entry earlier.
    fn new(
        gate: &GateController,
        inputs: &DMatrix<f64>,
        before: &DMatrix<f64>,
        activation: impl Fn(f64) -> f64,
    ) -> Result<Self, FitError> {
        let units = before.nrows();
        let from_input = columns(gate.input_transform.weight.val(), units)?;
        let from_hidden = columns(gate.hidden_transform.weight.val(), units)?;
        let mut sums = from_input * inputs + &from_hidden * before;
        for bias in [&gate.input_transform.bias, &gate.hidden_transform.bias].into_iter().flatten() {
            let bias = DVector::from_vec(values(bias.val())?);
            sums.column_iter_mut().for_each(|mut column| column += &bias);
        }
        let adjoint = DMatrix::zeros(units, inputs.ncols());
        Ok(Self { from_hidden, values: sums.map(activation), adjoint })
    }

    /// Passes the derivatives with respect to the gate's values at the entries from column `first` on to
    /// its sums, by the slope of its activation, a function of the value.
    fn pass(&mut self, first: usize, by_value: &DMatrix<f64>, slope: impl Fn(f64) -> f64) {
        let values = self.values.columns(first, by_value.ncols());
        let by_sum = by_value.zip_map(&values, |by, value| by * slope(value));
        self.adjoint.columns_mut(first, by_value.ncols()).copy_from(&by_sum);
    }

    /// The derivatives with respect to the gate's parameters in the order of the flat list: the input's
    /// weights and biases, the hidden state's weights and biases.
    fn gradient(&self, inputs: &DMatrix<f64>, before: &DMatrix<f64>) -> Vec<f64> {
        let biases = self.adjoint.column_sum();
        let weights = [&self.adjoint * inputs.transpose(), &self.adjoint * before.transpose()];
        weights.iter().flat_map(|weights| weights.iter().chain(&biases)).copied().collect()
    }
}

/// Derivatives with respect to the LSTM's parameters, in the order of the flat list, of a result whose
/// derivatives with respect to the last hidden states are `by_last`, sequences × units.
///
/// `inputs` of shape sequences × entries × features and `hidden`, all the hidden states that the LSTM gave
/// for them, of shape sequences × entries × units. With i, f, o, g the gates' values and δ the adjoints,
///
/// c = f·c₋ + i·g, h = o·tanh c, δc = δc₊·f₊ + δh·o·(1 − tanh²c), δh = Σ Uᵀδp₊.
///
/// # Errors
/// [`FitError::Backend`] where the LSTM has no forget gate or a tensor does not hold doubles.
pub(crate) fn backpropagate(
    lstm: &Lstm,
    inputs: Tensor<3>,
    hidden: Tensor<3>,
    by_last: Tensor<2>,
) -> Result<Vec<f64>, FitError> {
    let [sequences, entries, features] = inputs.dims();
    let units = lstm.d_hidden;
    let inputs = columns(inputs.swap_dims(0, 1), features)?;
    // Before the first entry the state is zero.
    let before = columns(hidden.swap_dims(0, 1), units)?
        .insert_columns(0, sequences, 0.0)
        .remove_columns(sequences * entries, sequences);
    let sigmoid = |x: f64| 1.0 / (1.0 + (-x).exp());
    let gate = |gate, activation: fn(f64) -> f64| Gate::new(gate, &inputs, &before, activation);
    let Some(forget) = &lstm.forget_gate else {
        return Err(FitError::Backend { problem: "an LSTM without a forget gate".to_owned() });
    };
    let mut input = gate(&lstm.input_gate, sigmoid)?;
    let mut forget = gate(forget, sigmoid)?;
    let mut output = gate(&lstm.output_gate, sigmoid)?;
    let mut candidate = gate(&lstm.cell_gate, f64::tanh)?;

    // The cells before each entry, and after the last one.
    let mut cells = DMatrix::zeros(units, sequences * (entries + 1));
    for at in 0..entries {
        let of = |matrix: &DMatrix<f64>| matrix.columns(at * sequences, sequences).into_owned();
        let kept = of(&forget.values).component_mul(&of(&cells));
        let added = of(&input.values).component_mul(&of(&candidate.values));
        cells.columns_mut((at + 1) * sequences, sequences).copy_from(&(kept + added));
    }

    let mut by_hidden = columns(by_last, units)?;
    let mut by_cell = DMatrix::<f64>::zeros(units, sequences);
    for at in (0..entries).rev() {
        let first = at * sequences;
        let of = |matrix: &DMatrix<f64>| matrix.columns(first, sequences).into_owned();
        let squashed = cells.columns(first + sequences, sequences).map(f64::tanh);
        let by_squashed = by_hidden.component_mul(&of(&output.values));
        by_cell += by_squashed.zip_map(&squashed, |by, squashed| by * (1.0 - squashed * squashed));
        let sigmoid_slope = |value: f64| value * (1.0 - value);
        output.pass(first, &by_hidden.component_mul(&squashed), sigmoid_slope);
        input.pass(first, &by_cell.component_mul(&of(&candidate.values)), sigmoid_slope);
        forget.pass(first, &by_cell.component_mul(&of(&cells)), sigmoid_slope);
        candidate.pass(first, &by_cell.component_mul(&of(&input.values)), |value| 1.0 - value * value);
        by_cell.component_mul_assign(&of(&forget.values));
        by_hidden.fill(0.0);
        for gate in [&input, &forget, &output, &candidate] {
            by_hidden.gemm_tr(1.0, &gate.from_hidden, &gate.adjoint.columns(first, sequences), 1.0);
        }
    }
    let gates = [&input, &forget, &output, &candidate];
    Ok(gates.iter().flat_map(|gate| gate.gradient(&inputs, &before)).collect())
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
            // Every parameter is something else, biases included.
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
            assert_eq!(values(found.said).unwrap(), values(said).unwrap());
            assert_eq!(values(found.loss).unwrap(), values(expected).unwrap());
            assert_eq!(found.gradient.len(), by_tape.len());
            let largest = by_tape.iter().copied().fold(0.0, |one: f64, other| one.max(other.abs()));
            for (at, (found, expected)) in found.gradient.iter().zip(&by_tape).enumerate() {
                assert!((found - expected).abs() < 1e-14 * largest, "{at}: {found} {expected}");
            }
            assert!(largest > 1e-2, "{largest}");
        }
    }
}
