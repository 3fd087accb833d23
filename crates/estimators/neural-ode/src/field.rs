//! Vector field: a network on burn, with exact derivatives.

use burn::module::{Module, Param};
use burn::nn::{Linear, LinearConfig};
use burn::tensor::{Device, Tensor};
use estimator::FitError;
use nalgebra::DMatrix;
use neural::{NamedTensor, tensor, values};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// Vector field f(y, s) = c + net(y, s): a perceptron of the state and the time with tanh between its layers,
/// all scaled. The bias of its last layer is c, the constant part, whose trajectory is a line.
///
/// The tanh bounds the field: |f| is at most |c| plus the sum of the last layer's absolute weights, so that
/// every trajectory exists for all times.
///
/// The parameters in the flat list are, for each layer, the weights by input (y before s) and then the
/// biases.
#[derive(Module, Debug)]
pub(crate) struct VectorField {
    layers: Vec<Linear>,
}

/// Derivatives of the field at several points.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Partials {
    /// ∂f/∂y, one value per point.
    pub(crate) by_state: Vec<f64>,
    /// ∂f/∂parameters, parameters by points.
    pub(crate) by_parameters: DMatrix<f64>,
}

/// Dimensions of a layer.
#[derive(Debug, Clone, Copy)]
struct Size {
    inputs: usize,
    outputs: usize,
}

fn sizes(hidden: &[usize]) -> Vec<Size> {
    let inputs = std::iter::once(2).chain(hidden.iter().copied());
    let outputs = hidden.iter().copied().chain([1]);
    inputs.zip(outputs).map(|(inputs, outputs)| Size { inputs, outputs }).collect()
}

impl VectorField {
    /// Returns the number of parameters of a field with the given hidden widths.
    pub(crate) fn parameter_count(hidden: &[usize]) -> usize {
        sizes(hidden).iter().map(|size| (size.inputs + 1) * size.outputs).sum()
    }

    /// Returns the positions of the parameters that are subject to weight decay. These are all but the ones
    /// that change when a line is added to the trajectory: the first layer's weights of time, its biases, and
    /// c.
    pub(crate) fn decayed(hidden: &[usize]) -> Vec<usize> {
        let Some(&width) = hidden.first() else { return Vec::new() };
        let count = Self::parameter_count(hidden);
        (0..width).chain(3 * width..count - 1).collect()
    }

    /// Draws start values: weights normal with variance 2/(inputs + outputs) (Glorot, Bengio, AISTATS 2010),
    /// biases normal; all times `scale`.
    pub(crate) fn draw_parameters(hidden: &[usize], scale: f64, generator: &mut impl Rng) -> Vec<f64> {
        let mut normal = || -> f64 { scale * Distribution::<f64>::sample(&StandardNormal, generator) };
        let mut parameters = Vec::with_capacity(Self::parameter_count(hidden));
        for size in sizes(hidden) {
            let spread = (2.0 / (size.inputs + size.outputs) as f64).sqrt();
            parameters.extend((0..size.inputs * size.outputs).map(|_| spread * normal()));
            parameters.extend((0..size.outputs).map(|_| normal()));
        }
        parameters
    }

    /// Creates the field with given hidden widths and parameters.
    pub(crate) fn from_parameters(
        hidden: &[usize],
        parameters: &[f64],
        device: &Device,
    ) -> Result<Self, FitError> {
        let expected = Self::parameter_count(hidden);
        let wrong_count = || FitError::Backend {
            problem: format!("{} parameters for a vector field of {expected}", parameters.len()),
        };
        if parameters.len() != expected {
            return Err(wrong_count());
        }
        let mut rest = parameters;
        let mut take = |count: usize| {
            let (part, after) = rest.split_at_checked(count).ok_or_else(wrong_count)?;
            rest = after;
            Ok::<Vec<f64>, FitError>(part.to_vec())
        };
        let mut layers = Vec::new();
        for Size { inputs, outputs } in sizes(hidden) {
            let mut layer = LinearConfig::new(inputs, outputs).init(device);
            layer.weight = Param::from_tensor(tensor(take(inputs * outputs)?, [inputs, outputs], device));
            let bias = tensor(take(outputs)?, [1, outputs], device).reshape([outputs]);
            layer.bias = Some(Param::from_tensor(bias));
            layers.push(layer);
        }
        Ok(Self { layers })
    }

    /// Evaluates the field at points of shape points × 2 (state, time); the result has the shape points × 1.
    pub(crate) fn forward(&self, points: Tensor<2>) -> Tensor<2> {
        let last = self.layers.len().saturating_sub(1);
        self.layers.iter().enumerate().fold(points, |input, (at, layer)| {
            let sums = layer.forward(input);
            if at < last { sums.tanh() } else { sums }
        })
    }

    /// Evaluates the field at one point.
    pub(crate) fn at(&self, state: f64, time: f64, device: &Device) -> Result<f64, FitError> {
        let value = values(self.forward(tensor(vec![state, time], [1, 2], device)))?;
        value.first().copied().ok_or_else(|| FitError::Backend { problem: "an empty tensor".to_owned() })
    }

    /// Returns exact derivatives at many points (state, time) by one backward pass.
    ///
    /// A zero, the tap, is added to every layer's sums at each point. The points do not interact, so that the
    /// gradient of the sum of all values with respect to a tap holds, at each point, that point's own
    /// derivative with respect to its sums. Multiplied by the layer's input it is the derivative with respect
    /// to the weights, and multiplied by the first layer's weights it is the derivative with respect to the
    /// state.
    pub(crate) fn partials(&self, points: &[[f64; 2]], device: &Device) -> Result<Partials, FitError> {
        let recording = device.clone().autodiff();
        let network = self.clone().fork(&recording);
        let rows = points.len();
        let last = network.layers.len().saturating_sub(1);
        let mut input = tensor(points.as_flattened().to_vec(), [rows, 2], &recording);
        let mut taps = Vec::new();
        for (at, layer) in network.layers.iter().enumerate() {
            let outputs = layer.weight.val().dims()[1];
            let tap = Tensor::<2>::zeros([rows, outputs], &recording).require_grad();
            let sums = layer.forward(input.clone()) + tap.clone();
            taps.push((input, tap));
            input = if at < last { sums.tanh() } else { sums };
        }
        let gradients = input.sum().backward();
        // Rows of burn's tensors are the points, which are columns here.
        let by_points = |tensor: Tensor<2>| -> Result<DMatrix<f64>, FitError> {
            let [rows, columns] = tensor.dims();
            Ok(DMatrix::from_vec(columns, rows, values(tensor)?))
        };
        let mut by_parameters = DMatrix::zeros(self.num_params(), rows);
        let mut by_state = Vec::new();
        let mut row = 0;
        for (input, tap) in taps {
            let gradient = tap
                .grad(&gradients)
                .ok_or_else(|| FitError::Backend { problem: "a layer without a gradient".to_owned() })?;
            if by_state.is_empty() {
                let weight = self.layers.first().map(|layer| layer.weight.val().narrow(0, 0, 1));
                let weight = weight.unwrap_or_else(|| Tensor::zeros([1, 1], device));
                by_state = values(gradient.clone().matmul(weight.transpose()))?;
            }
            let (input, gradient) = (by_points(input.inner())?, by_points(gradient)?);
            for x in input.row_iter() {
                for g in gradient.row_iter() {
                    by_parameters.row_mut(row).copy_from(&x.component_mul(&g));
                    row += 1;
                }
            }
            by_parameters.rows_mut(row, gradient.nrows()).copy_from(&gradient);
            row += gradient.nrows();
        }
        Ok(Partials { by_state, by_parameters })
    }

    /// Returns the weights by name, for a file.
    pub(crate) fn named_tensors(&self) -> Result<Vec<NamedTensor>, FitError> {
        let mut tensors = Vec::new();
        for (at, layer) in self.layers.iter().enumerate() {
            let weight = layer.weight.val();
            let bias = layer.bias.as_ref().map(|bias| bias.val());
            tensors.push(NamedTensor {
                name: format!("layers.{at}.weight"),
                shape: weight.dims().to_vec(),
                values: values(weight)?,
            });
            if let Some(bias) = bias {
                tensors.push(NamedTensor {
                    name: format!("layers.{at}.bias"),
                    shape: bias.dims().to_vec(),
                    values: values(bias)?,
                });
            }
        }
        Ok(tensors)
    }
}

#[cfg(test)]
mod tests {
    use super::VectorField;
    use neural::{device, tensor, values};
    use rand::RngExt;
    use seed::Seed;

    const HIDDEN: &[usize] = &[5, 4];
    const POINTS: &[[f64; 2]] = &[[-0.9, -1.0], [0.2, -0.3], [1.4, 0.5], [0.0, 1.0]];

    fn parameters() -> Vec<f64> {
        VectorField::draw_parameters(HIDDEN, 0.8, &mut Seed::new(5).generator())
    }

    fn forward(parameters: &[f64], points: &[[f64; 2]]) -> Vec<f64> {
        let device = device().unwrap();
        let field = VectorField::from_parameters(HIDDEN, parameters, &device).unwrap();
        values(field.forward(tensor(points.as_flattened().to_vec(), [points.len(), 2], &device))).unwrap()
    }

    /// Returns a fourth-order central difference.
    fn difference(f: impl Fn(f64) -> f64) -> f64 {
        let h = 1e-3;
        (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)
    }

    #[test]
    fn the_partials_are_exact() {
        let (device, parameters) = (device().unwrap(), parameters());
        let field = VectorField::from_parameters(HIDDEN, &parameters, &device).unwrap();
        let partials = field.partials(POINTS, &device).unwrap();
        assert_eq!(partials.by_parameters.shape(), (parameters.len(), POINTS.len()));
        for (at, &[state, time]) in POINTS.iter().enumerate() {
            let expected = difference(|h| forward(&parameters, &[[state + h, time]])[0]);
            assert!((partials.by_state[at] - expected).abs() < 1e-10);
            for parameter in 0..parameters.len() {
                let expected = difference(|h| {
                    let mut moved = parameters.clone();
                    moved[parameter] += h;
                    forward(&moved, &[[state, time]])[0]
                });
                assert!((partials.by_parameters[(parameter, at)] - expected).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn one_point_is_what_it_is_among_many_and_bounded() {
        let (device, parameters) = (device().unwrap(), parameters());
        let field = VectorField::from_parameters(HIDDEN, &parameters, &device).unwrap();
        for (&[state, time], among) in POINTS.iter().zip(forward(&parameters, POINTS)) {
            assert!((field.at(state, time, &device).unwrap() - among).abs() < 1e-14);
        }
        let (constant, last) = (parameters[parameters.len() - 1], &parameters[parameters.len() - 5..]);
        let bound = constant.abs() + last[..4].iter().map(|weight| weight.abs()).sum::<f64>();
        let mut generator = Seed::new(6).generator();
        for _ in 0..100 {
            let state = 1e3 * (generator.random::<f64>() - 0.5);
            assert!(field.at(state, 0.3, &device).unwrap().abs() <= bound);
        }
    }

    #[test]
    fn a_wrong_number_of_parameters_is_refused() {
        let device = device().unwrap();
        for count in [0, 10, parameters().len() + 1] {
            let result = VectorField::from_parameters(HIDDEN, &vec![0.1; count], &device);
            let refused = result.map(|_| ()).unwrap_err().to_string();
            assert!(refused.contains(&format!("{count} parameters for a vector field of ")), "{refused}");
        }
    }
}
