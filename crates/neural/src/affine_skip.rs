//! Network with an affine skip connection: f(t) = a + b·t + net(t), with exact Jacobians.
//!
//! A Jacobian takes one backward pass, since the points of a batch do not interact: the gradient of the summed output
//! with respect to a zero added to each layer holds every point's own derivative. Passes row by row cost a hundred
//! times as much.

use crate::device::{tensor, values};
use crate::weights::NamedTensor;
use burn::module::{Module, Param};
use burn::nn::{Linear, LinearConfig};
use burn::tensor::{Device, Tensor};
use estimator::FitError;
use nalgebra::DMatrix;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// Network f(t) = a + b·t + net(t), where `net` is a perceptron with tanh between its layers, and t and f are
/// scalar.
///
/// The skip connection carries the linear part; the network learns the rest. At a stationary point of a
/// squared loss, the residuals are orthogonal to 1 and to t.
///
/// Order of the flat parameter list: for each layer the weights by input, then the biases; then a; then b.
#[derive(Module, Debug)]
pub struct AffineSkipNetwork {
    layers: Vec<Linear>,
    intercept: Param<Tensor<1>>,
    slope: Param<Tensor<1>>,
}

/// Values and their derivatives with respect to the parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearization {
    /// Values, one per point.
    pub values: Vec<f64>,
    /// Jacobian, points × parameters.
    pub jacobian: DMatrix<f64>,
}

/// Size of a layer.
#[derive(Debug, Clone, Copy)]
struct Size {
    inputs: usize,
    outputs: usize,
}

fn sizes(hidden: &[usize]) -> Vec<Size> {
    let inputs = std::iter::once(1).chain(hidden.iter().copied());
    let outputs = hidden.iter().copied().chain([1]);
    inputs.zip(outputs).map(|(inputs, outputs)| Size { inputs, outputs }).collect()
}

impl AffineSkipNetwork {
    /// Returns the number of parameters of a network with the given hidden widths.
    #[must_use]
    pub fn parameter_count(hidden: &[usize]) -> usize {
        sizes(hidden).iter().map(|size| (size.inputs + 1) * size.outputs).sum::<usize>() + 2
    }

    /// Draws initial values from a generator: weights normal with variance 2/(inputs + outputs) (Glorot,
    /// Bengio, AISTATS 2010), biases, a and b standard normal; all multiplied by `scale`.
    #[must_use]
    pub fn draw_parameters(hidden: &[usize], scale: f64, generator: &mut impl Rng) -> Vec<f64> {
        let mut normal = || -> f64 { scale * Distribution::<f64>::sample(&StandardNormal, generator) };
        let mut parameters = Vec::with_capacity(Self::parameter_count(hidden));
        for size in sizes(hidden) {
            let spread = (2.0 / (size.inputs + size.outputs) as f64).sqrt();
            parameters.extend((0..size.inputs * size.outputs).map(|_| spread * normal()));
            parameters.extend((0..size.outputs).map(|_| normal()));
        }
        parameters.extend([normal(), normal()]);
        parameters
    }

    /// Builds a network with given hidden widths and parameters.
    ///
    /// # Errors
    /// [`FitError::Backend`] if the number of parameters is not [`parameter_count`](Self::parameter_count).
    pub fn from_parameters(hidden: &[usize], parameters: &[f64], device: &Device) -> Result<Self, FitError> {
        let expected = Self::parameter_count(hidden);
        let wrong_count = || FitError::Backend {
            problem: format!("{} parameters for a network of {expected}", parameters.len()),
        };
        let mut rest = parameters;
        let mut take = |count: usize| {
            let (part, after) = rest.split_at_checked(count).ok_or_else(wrong_count)?;
            rest = after;
            Ok::<Vec<f64>, FitError>(part.to_vec())
        };
        let vector = |values: Vec<f64>| {
            let columns = values.len();
            Param::from_tensor(tensor(values, [1, columns], device).reshape([columns]))
        };
        let mut layers = Vec::new();
        for size in sizes(hidden) {
            let mut layer = LinearConfig::new(size.inputs, size.outputs).init(device);
            let weights = take(size.inputs * size.outputs)?;
            layer.weight = Param::from_tensor(tensor(weights, [size.inputs, size.outputs], device));
            layer.bias = Some(vector(take(size.outputs)?));
            layers.push(layer);
        }
        let (intercept, slope) = (vector(take(1)?), vector(take(1)?));
        if parameters.len() == expected { Ok(Self { layers, intercept, slope }) } else { Err(wrong_count()) }
    }

    /// Returns the values at the points `t`, of shape points × 1.
    #[must_use]
    pub fn forward(&self, t: &Tensor<2>) -> Tensor<2> {
        let mut hidden = t.clone();
        for (at, layer) in self.layers.iter().enumerate() {
            hidden = layer.forward(hidden);
            if at + 1 < self.layers.len() {
                hidden = hidden.tanh();
            }
        }
        hidden + self.skip(t)
    }

    /// Returns the values at the points `t`, of shape points × 1, and their derivatives with respect to t.
    ///
    /// The derivatives are carried forward through the layers with the values: d(x·W + c) = dx·W, d tanh(p) =
    /// (1 − tanh²(p))·dp.
    #[must_use]
    pub fn forward_with_derivative(&self, t: &Tensor<2>) -> (Tensor<2>, Tensor<2>) {
        let (value, derivative, _) = self.pass(t, false);
        (value, derivative)
    }

    /// Returns the values at the points `t` with their exact derivatives with respect to every parameter.
    ///
    /// # Errors
    /// [`FitError::Backend`] if burn gives no gradient.
    pub fn linearize_values(&self, t: &[f64], device: &Device) -> Result<Linearization, FitError> {
        self.linearize(t, device, Of::Value)
    }

    /// Returns the derivatives with respect to t at the points `t`, with *their* exact derivatives with
    /// respect to every parameter.
    ///
    /// # Errors
    /// [`FitError::Backend`] if burn gives no gradient.
    pub fn linearize_derivatives(&self, t: &[f64], device: &Device) -> Result<Linearization, FitError> {
        self.linearize(t, device, Of::Derivative)
    }

    /// Returns the weights by name, for a file.
    ///
    /// # Errors
    /// [`FitError::Backend`] if a tensor does not hold doubles.
    pub fn named_tensors(&self) -> Result<Vec<NamedTensor>, FitError> {
        let mut tensors = Vec::new();
        for (at, layer) in self.layers.iter().enumerate() {
            let weight = layer.weight.val();
            tensors.push(NamedTensor {
                name: format!("layers.{at}.weight"),
                shape: weight.dims().to_vec(),
                values: values(weight)?,
            });
            if let Some(bias) = &layer.bias {
                let bias = bias.val();
                tensors.push(NamedTensor {
                    name: format!("layers.{at}.bias"),
                    shape: bias.dims().to_vec(),
                    values: values(bias)?,
                });
            }
        }
        for (name, parameter) in [("intercept", &self.intercept), ("slope", &self.slope)] {
            tensors.push(NamedTensor {
                name: name.to_owned(),
                shape: vec![1],
                values: values(parameter.val())?,
            });
        }
        Ok(tensors)
    }

    fn skip(&self, t: &Tensor<2>) -> Tensor<2> {
        t.clone() * self.slope.val().unsqueeze() + self.intercept.val().unsqueeze()
    }

    /// Runs the forward pass of (value, derivative) pairs, with a tap at every layer if requested.
    fn pass(&self, t: &Tensor<2>, tapped: bool) -> (Tensor<2>, Tensor<2>, Vec<Tap>) {
        let points = t.dims()[0];
        let mut value = t.clone();
        let mut derivative = t.ones_like();
        let mut taps = Vec::new();
        for (at, layer) in self.layers.iter().enumerate() {
            let weight = layer.weight.val();
            let mut pre = layer.forward(value.clone());
            let mut pre_derivative = derivative.clone().matmul(weight.clone());
            if tapped {
                let zeros = || Tensor::<2>::zeros([points, weight.dims()[1]], &t.device()).require_grad();
                let tap = Tap {
                    input: value,
                    input_derivative: derivative,
                    at_value: zeros(),
                    at_derivative: zeros(),
                };
                pre = pre + tap.at_value.clone();
                pre_derivative = pre_derivative + tap.at_derivative.clone();
                taps.push(tap);
            }
            if at + 1 < self.layers.len() {
                value = pre.tanh();
                derivative = (value.ones_like() - value.clone() * value.clone()) * pre_derivative;
            } else {
                value = pre;
                derivative = pre_derivative;
            }
        }
        let slope = self.slope.val().unsqueeze();
        (value + self.skip(t), derivative + slope, taps)
    }

    /// Computes all rows of the Jacobian in one backward pass.
    ///
    /// A zero, the tap, is added to every layer's pre-activations, point by point. The points do not
    /// interact, so the gradient of the *sum* of all outputs with respect to a tap contains each point's own
    /// derivative with respect to its pre-activations. Multiplied by the layer's input, this is the point's
    /// derivative with respect to the weights.
    fn linearize(&self, t: &[f64], device: &Device, of: Of) -> Result<Linearization, FitError> {
        let recording = device.clone().autodiff();
        let network = self.clone().fork(&recording);
        let input = tensor(t.to_vec(), [t.len(), 1], &recording);
        let (value, derivative, taps) = network.pass(&input, true);
        let output = match of {
            Of::Value => value,
            Of::Derivative => derivative,
        };
        let gradients = output.clone().sum().backward();
        let matrix = |tensor: Tensor<2>| -> Result<DMatrix<f64>, FitError> {
            let [rows, columns] = tensor.dims();
            Ok(DMatrix::from_row_slice(rows, columns, &values(tensor.inner())?))
        };
        let gradient = |tap: &Tensor<2>| -> Result<DMatrix<f64>, FitError> {
            match tap.grad(&gradients) {
                Some(gradient) => {
                    let [rows, columns] = gradient.dims();
                    Ok(DMatrix::from_row_slice(rows, columns, &values(gradient)?))
                }
                // A value does not depend on the derivative carried beside it.
                None => {
                    let [rows, columns] = tap.dims();
                    Ok(DMatrix::zeros(rows, columns))
                }
            }
        };
        let mut columns = Vec::new();
        for tap in taps {
            let (inputs, input_derivatives) = (matrix(tap.input)?, matrix(tap.input_derivative)?);
            let (at_value, at_derivative) = (gradient(&tap.at_value)?, gradient(&tap.at_derivative)?);
            for (x, dx) in inputs.column_iter().zip(input_derivatives.column_iter()) {
                for (one, other) in at_value.column_iter().zip(at_derivative.column_iter()) {
                    columns.push(x.component_mul(&one) + dx.component_mul(&other));
                }
            }
            columns.extend(at_value.column_iter().map(|column| column.into_owned()));
        }
        let skip = match of {
            Of::Value => [vec![1.0; t.len()], t.to_vec()],
            Of::Derivative => [vec![0.0; t.len()], vec![1.0; t.len()]],
        };
        columns.extend(skip.into_iter().map(Into::into));
        Ok(Linearization { values: values(output.inner())?, jacobian: DMatrix::from_columns(&columns) })
    }
}

/// Quantity that is linearized.
#[derive(Debug, Clone, Copy)]
enum Of {
    Value,
    Derivative,
}

/// Inputs of a layer, and the zeros added to its pre-activations.
struct Tap {
    input: Tensor<2>,
    input_derivative: Tensor<2>,
    at_value: Tensor<2>,
    at_derivative: Tensor<2>,
}

#[cfg(test)]
mod tests {
    use super::AffineSkipNetwork;
    use crate::device::{device, tensor, values};
    use rand::SeedableRng;
    use rand::rngs::StdRng;

    const HIDDEN: &[usize] = &[5, 4];
    const POINTS: &[f64] = &[-0.9, -0.2, 0.4, 1.3];

    fn parameters() -> Vec<f64> {
        AffineSkipNetwork::draw_parameters(HIDDEN, 0.8, &mut StdRng::seed_from_u64(5))
    }

    fn forward(parameters: &[f64], points: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let device = device().unwrap();
        let network = AffineSkipNetwork::from_parameters(HIDDEN, parameters, &device).unwrap();
        let input = tensor(points.to_vec(), [points.len(), 1], &device);
        let (value, derivative) = network.forward_with_derivative(&input);
        assert_eq!(values(network.forward(&input)).unwrap(), values(value.clone()).unwrap());
        (values(value).unwrap(), values(derivative).unwrap())
    }

    /// Fourth-order central difference.
    fn difference(f: impl Fn(f64) -> f64) -> f64 {
        let h = 1e-3;
        (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)
    }

    #[test]
    fn the_input_derivative_is_exact() {
        let parameters = parameters();
        let (_, derivatives) = forward(&parameters, POINTS);
        for (&point, found) in POINTS.iter().zip(derivatives) {
            let expected = difference(|h| forward(&parameters, &[point + h]).0[0]);
            assert!((found - expected).abs() < 1e-10, "{found} {expected}");
        }
    }

    #[test]
    fn both_jacobians_are_exact() {
        let parameters = parameters();
        let device = device().unwrap();
        let network = AffineSkipNetwork::from_parameters(HIDDEN, &parameters, &device).unwrap();
        let of_values = network.linearize_values(POINTS, &device).unwrap();
        let of_derivatives = network.linearize_derivatives(POINTS, &device).unwrap();
        let (plain_values, plain_derivatives) = forward(&parameters, POINTS);
        assert_eq!(of_values.values, plain_values);
        assert_eq!(of_derivatives.values, plain_derivatives);
        assert_eq!(of_values.jacobian.shape(), (POINTS.len(), parameters.len()));
        for column in 0..parameters.len() {
            let moved = |h: f64| {
                let mut moved = parameters.clone();
                moved[column] += h;
                forward(&moved, POINTS)
            };
            for row in 0..POINTS.len() {
                let expected = difference(|h| moved(h).0[row]);
                assert!((of_values.jacobian[(row, column)] - expected).abs() < 1e-10);
                let expected = difference(|h| moved(h).1[row]);
                assert!((of_derivatives.jacobian[(row, column)] - expected).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn a_wrong_number_of_parameters_is_refused() {
        let device = device().unwrap();
        for count in [0, 10, parameters().len() + 1] {
            let result = AffineSkipNetwork::from_parameters(HIDDEN, &vec![0.1; count], &device);
            let refused = result.map(|_| ()).unwrap_err().to_string();
            assert!(refused.contains(&format!("{count} parameters for ")), "{refused}");
        }
    }
}
