//! Affine-skip network on plain matrices: values, input derivatives and exact Jacobians without a tape.
//!
//! A tape keeps a node and a tensor for every small operation. For a network of a few hundred weights and a
//! few hundred points, this takes most of the training time; the hand-written adjoint is a dozen matrix
//! products. A test checks that both agree up to rounding.
//!
//! Reference: Griewank, Walther, Evaluating Derivatives, 2nd ed. (SIAM 2008), chapter 3 (adjoints by hand).

use crate::affine_skip::AffineSkipNetwork;
use estimator::FitError;
use nalgebra::{DMatrix, DMatrixViewMut, RowDVector};

/// Network f(t) = a + b·t + net(t) with its weights as matrices. It takes the flat parameter list of
/// [`AffineSkipNetwork`].
#[derive(Debug, Clone, PartialEq)]
pub struct PlainNetwork {
    layers: Vec<Layer>,
    intercept: f64,
    slope: f64,
}

#[derive(Debug, Clone, PartialEq)]
struct Layer {
    /// Weights, inputs × outputs.
    weights: DMatrix<f64>,
    biases: RowDVector<f64>,
}

/// Quantity that is computed or linearized.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Of {
    /// Values of the network.
    Value,
    /// Derivatives of the values with respect to the input.
    Derivative,
}

/// Inputs of a layer at all points, points × inputs, and their derivatives with respect to t.
struct Carried {
    value: DMatrix<f64>,
    derivative: DMatrix<f64>,
}

impl PlainNetwork {
    /// Builds a network with given hidden widths and the parameters in the order of the flat list.
    ///
    /// # Errors
    /// [`FitError::Backend`] if the number of parameters is not
    /// [`parameter_count`](AffineSkipNetwork::parameter_count).
    pub fn new(hidden: &[usize], parameters: &[f64]) -> Result<Self, FitError> {
        let expected = AffineSkipNetwork::parameter_count(hidden);
        let wrong_count = || FitError::Backend {
            problem: format!("{} parameters for a network of {expected}", parameters.len()),
        };
        if parameters.len() != expected {
            return Err(wrong_count());
        }
        let mut rest = parameters;
        let mut take = |count: usize| {
            let (part, after) = rest.split_at_checked(count).ok_or_else(wrong_count)?;
            rest = after;
            Ok::<&[f64], FitError>(part)
        };
        let mut layers = Vec::with_capacity(hidden.len() + 1);
        let mut inputs = 1;
        for &outputs in hidden.iter().chain(&[1]) {
            let weights = DMatrix::from_row_slice(inputs, outputs, take(inputs * outputs)?);
            layers.push(Layer { weights, biases: RowDVector::from_row_slice(take(outputs)?) });
            inputs = outputs;
        }
        let [intercept, slope] = take(2)?.first_chunk::<2>().copied().ok_or_else(wrong_count)?;
        Ok(Self { layers, intercept, slope })
    }

    /// Returns values or derivatives, one per point.
    #[must_use]
    pub fn at(&self, of: Of, t: &[f64]) -> Vec<f64> {
        let (carried, _) = self.forward(of, t, false);
        self.output(of, t, &carried)
    }

    /// Returns the outputs of the last hidden layer, or their derivatives, as points × width: the factors of
    /// the last layer's weights.
    #[must_use]
    pub fn last_hidden(&self, of: Of, t: &[f64]) -> DMatrix<f64> {
        let (_, mut inputs) = self.forward(of, t, true);
        // There is always an output layer.
        inputs.pop().map_or_else(
            || DMatrix::zeros(t.len(), 0),
            |last| match of {
                Of::Value => last.value,
                Of::Derivative => last.derivative,
            },
        )
    }

    /// Returns values or derivatives at points. Writes `scale` times their derivatives with respect to every
    /// parameter into `jacobian`, points × parameters; all of it is overwritten.
    #[must_use]
    pub fn linearize(
        &self,
        of: Of,
        t: &[f64],
        scale: f64,
        mut jacobian: DMatrixViewMut<'_, f64>,
    ) -> Vec<f64> {
        debug_assert_eq!(jacobian.nrows(), t.len());
        let (last, inputs) = self.forward(of, t, true);
        let parameters = jacobian.ncols();
        jacobian.column_mut(parameters - 2).fill(if of == Of::Value { scale } else { 0.0 });
        let mut slope = jacobian.column_mut(parameters - 1);
        match of {
            Of::Value => slope.iter_mut().zip(t).for_each(|(entry, t)| *entry = scale * t),
            Of::Derivative => slope.fill(scale),
        }
        // Adjoints of a layer's pre-activations and of their derivatives; for the last layer, these are those
        // of the output.
        let ones = DMatrix::from_element(t.len(), 1, scale);
        let (mut by_value, mut by_derivative) = match of {
            Of::Value => (ones, None),
            Of::Derivative => (DMatrix::zeros(t.len(), 1), Some(ones)),
        };
        let mut end = parameters - 2;
        for (layer, input) in self.layers.iter().zip(&inputs).rev() {
            let (rows, columns) = layer.weights.shape();
            let begin = end - (rows + 1) * columns;
            for output in 0..columns {
                let adjoint = by_value.column(output);
                for row in 0..rows {
                    let mut entry = jacobian.column_mut(begin + row * columns + output);
                    entry.copy_from(&adjoint);
                    entry.component_mul_assign(&input.value.column(row));
                    if let Some(by_derivative) = &by_derivative {
                        let other = by_derivative.column(output);
                        let pairs = input.derivative.column(row);
                        let products = other.iter().zip(pairs.iter());
                        entry.iter_mut().zip(products).for_each(|(entry, (a, b))| *entry += a * b);
                    }
                }
                jacobian.column_mut(begin + rows * columns + output).copy_from(&adjoint);
            }
            if begin == 0 {
                break;
            }
            (by_value, by_derivative) = back(layer, input, &by_value, by_derivative.as_ref());
            end = begin;
        }
        self.output(of, t, &last)
    }

    fn output(&self, of: Of, t: &[f64], last: &Carried) -> Vec<f64> {
        match of {
            Of::Value => {
                let skip = t.iter().map(|t| self.intercept + self.slope * t);
                last.value.iter().zip(skip).map(|(value, skip)| value + skip).collect()
            }
            Of::Derivative => last.derivative.iter().map(|derivative| derivative + self.slope).collect(),
        }
    }

    /// Returns the last layer's pre-activations and, if requested, every layer's inputs. Derivatives are
    /// carried only if they are requested.
    fn forward(&self, of: Of, t: &[f64], kept: bool) -> (Carried, Vec<Carried>) {
        let derivative = match of {
            Of::Value => DMatrix::zeros(0, 0),
            Of::Derivative => DMatrix::from_element(t.len(), 1, 1.0),
        };
        let mut now = Carried { value: DMatrix::from_column_slice(t.len(), 1, t), derivative };
        let mut inputs = Vec::with_capacity(self.layers.len());
        for (at, layer) in self.layers.iter().enumerate() {
            let mut value = &now.value * &layer.weights;
            for (mut column, bias) in value.column_iter_mut().zip(layer.biases.iter()) {
                column.add_scalar_mut(*bias);
            }
            let mut derivative = match of {
                Of::Value => DMatrix::zeros(0, 0),
                Of::Derivative => &now.derivative * &layer.weights,
            };
            if at + 1 < self.layers.len() {
                value.apply(|sum| *sum = sum.tanh());
                derivative.iter_mut().zip(value.iter()).for_each(|(by, value)| *by *= 1.0 - value * value);
            }
            let next = Carried { value, derivative };
            let before = std::mem::replace(&mut now, next);
            if kept {
                inputs.push(before);
            }
        }
        (now, inputs)
    }
}

/// Propagates the adjoints of a layer's pre-activations to the layer below, whose outputs are `input`: x =
/// tanh(p), x′ = (1 − x²)·p′. The factor 1 − x² of p′ is already in x′, so that −2·x·p′·(1 − x²) = −2·x·x′.
fn back(
    layer: &Layer,
    input: &Carried,
    by_value: &DMatrix<f64>,
    by_derivative: Option<&DMatrix<f64>>,
) -> (DMatrix<f64>, Option<DMatrix<f64>>) {
    let transposed = layer.weights.transpose();
    let mut value = by_value * &transposed;
    let mut derivative = by_derivative.map(|by| by * &transposed);
    match &mut derivative {
        None => value.iter_mut().zip(input.value.iter()).for_each(|(by, x)| *by *= 1.0 - x * x),
        Some(derivative) => {
            let carried = input.value.iter().zip(input.derivative.iter());
            let adjoints = value.iter_mut().zip(derivative.iter_mut());
            for ((by, by_slope), (x, dx)) in adjoints.zip(carried) {
                let slope = 1.0 - x * x;
                *by = *by * slope - 2.0 * x * dx * *by_slope;
                *by_slope *= slope;
            }
        }
    }
    (value, derivative)
}

#[cfg(test)]
mod tests {
    use super::{Of, PlainNetwork};
    use crate::affine_skip::AffineSkipNetwork;
    use crate::device::device;
    use nalgebra::DMatrix;
    use rand::SeedableRng;
    use rand::rngs::StdRng;

    const POINTS: &[f64] = &[-0.9, -0.2, 0.4, 1.3, 2.0];

    #[test]
    fn it_is_the_networks_own_linearization() {
        let device = device().unwrap();
        for hidden in [&[5, 4][..], &[3], &[2, 6, 3]] {
            let parameters = AffineSkipNetwork::draw_parameters(hidden, 0.8, &mut StdRng::seed_from_u64(5));
            let network = AffineSkipNetwork::from_parameters(hidden, &parameters, &device).unwrap();
            let plain = PlainNetwork::new(hidden, &parameters).unwrap();
            let taped = [
                (Of::Value, network.linearize_values(POINTS, &device).unwrap()),
                (Of::Derivative, network.linearize_derivatives(POINTS, &device).unwrap()),
            ];
            for (of, expected) in taped {
                let mut jacobian = DMatrix::from_element(POINTS.len(), parameters.len(), f64::NAN);
                let found = plain.linearize(of, POINTS, 2.0, jacobian.as_view_mut());
                assert_eq!(found, plain.at(of, POINTS));
                let close = |a: f64, b: f64| (a - b).abs() < 1e-13 * b.abs().max(1.0);
                assert!(found.iter().zip(&expected.values).all(|(a, b)| close(*a, *b)), "{of:?}");
                let pairs = jacobian.iter().zip(expected.jacobian.iter());
                assert!(pairs.clone().all(|(a, b)| close(*a, 2.0 * b)), "{of:?} {hidden:?}");
            }
        }
    }

    #[test]
    fn a_wrong_number_of_parameters_is_refused() {
        for count in [0, 10, 100] {
            let refused = PlainNetwork::new(&[5, 4], &vec![0.1; count]).map(|_| ()).unwrap_err().to_string();
            assert!(refused.contains(&format!("{count} parameters for a network of ")), "{refused}");
        }
    }
}
