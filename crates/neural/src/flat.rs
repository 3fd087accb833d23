//! Parameters of any burn module as one flat list, for optimizers that work on vectors.
//!
//! The order is that of the module's fields; within a tensor, the last axis varies fastest. A module built
//! with zeros and then filled from such a list never uses burn's global random generator.

use crate::device::values;
use crate::weights::NamedTensor;
use burn::module::{Module, ModuleMapper, ModuleVisitor, Param};
use burn::tensor::{Device, Gradients, Tensor, TensorData};
use estimator::FitError;

/// Returns a module's parameters by name, such as `encoder.layers.0.norm_1.gamma`.
///
/// # Errors
/// [`FitError::Backend`] if a parameter does not hold doubles.
pub fn named_parameters(module: &impl Module) -> Result<Vec<NamedTensor>, FitError> {
    struct Names {
        path: Vec<String>,
        found: Result<Vec<NamedTensor>, FitError>,
    }
    impl ModuleVisitor for Names {
        fn enter_module(&mut self, name: &str, _container: &str) {
            self.path.push(name.to_owned());
        }
        fn exit_module(&mut self, _name: &str, _container: &str) {
            self.path.pop();
        }
        fn visit_float<const D: usize>(&mut self, parameter: &Param<Tensor<D>>) {
            let Ok(found) = &mut self.found else { return };
            let tensor = parameter.val();
            let (name, shape) = (self.path.join("."), tensor.dims().to_vec());
            match values(tensor) {
                Ok(values) => found.push(NamedTensor { name, shape, values }),
                Err(error) => self.found = Err(error),
            }
        }
    }
    let mut names = Names { path: Vec::new(), found: Ok(Vec::new()) };
    module.visit(&mut names);
    names.found
}

/// Returns the module on a device, with its parameters taken from a flat list. On a recording device, the
/// parameters require gradients.
///
/// # Errors
/// [`FitError::Backend`] if the list is longer or shorter than the module's parameters.
pub fn with_parameters<M: Module>(module: M, parameters: &[f64], device: &Device) -> Result<M, FitError> {
    struct Fill<'a> {
        rest: &'a [f64],
        missing: usize,
        device: &'a Device,
    }
    impl ModuleMapper for Fill<'_> {
        fn map_float<const D: usize>(&mut self, parameter: Param<Tensor<D>>) -> Param<Tensor<D>> {
            let shape = parameter.lazy_shape();
            let count = shape.num_elements();
            let Some((part, rest)) = self.rest.split_at_checked(count) else {
                self.missing += count - self.rest.len();
                self.rest = &[];
                return parameter;
            };
            self.rest = rest;
            let tensor = Tensor::from_data(TensorData::new(part.to_vec(), shape), self.device);
            let records = self.device.is_autodiff();
            Param::initialized(parameter.id, if records { tensor.require_grad() } else { tensor })
        }
    }
    let mut fill = Fill { rest: parameters, missing: 0, device };
    let module = module.map(&mut fill);
    if fill.missing > 0 || !fill.rest.is_empty() {
        let expected = parameters.len() + fill.missing - fill.rest.len();
        return Err(FitError::Backend {
            problem: format!("{} parameters for a network of {expected}", parameters.len()),
        });
    }
    Ok(module)
}

/// Returns the gradients of a module's parameters in the order of the flat list; 0 for a parameter that the
/// result does not depend on.
///
/// # Errors
/// [`FitError::Backend`] if a gradient does not hold doubles.
pub fn flat_gradient(module: &impl Module, gradients: &Gradients) -> Result<Vec<f64>, FitError> {
    struct Collect<'a> {
        gradients: &'a Gradients,
        found: Result<Vec<f64>, FitError>,
    }
    impl ModuleVisitor for Collect<'_> {
        fn visit_float<const D: usize>(&mut self, parameter: &Param<Tensor<D>>) {
            let Ok(found) = &mut self.found else { return };
            match parameter.val().grad(self.gradients).map(values) {
                Some(Ok(part)) => found.extend(part),
                Some(Err(error)) => self.found = Err(error),
                None => found.extend(std::iter::repeat_n(0.0, parameter.lazy_shape().num_elements())),
            }
        }
    }
    let mut collect = Collect { gradients, found: Ok(Vec::new()) };
    module.visit(&mut collect);
    collect.found
}

#[cfg(test)]
mod tests {
    use super::{flat_gradient, named_parameters, with_parameters};
    use crate::device::{device, tensor, values};
    use burn::module::Module;
    use burn::nn::{Initializer, LayerNorm, LayerNormConfig, Linear, LinearConfig};

    #[derive(Module, Debug)]
    struct Small {
        layers: Vec<Linear>,
        norm: LayerNorm,
    }

    fn small() -> Small {
        let device = device().unwrap();
        let layer = |inputs, outputs| {
            LinearConfig::new(inputs, outputs).with_initializer(Initializer::Zeros).init(&device)
        };
        Small { layers: vec![layer(2, 3), layer(3, 1)], norm: LayerNormConfig::new(3).init(&device) }
    }

    fn ramp() -> Vec<f64> {
        (0..19).map(|at| 0.1 * f64::from(at)).collect()
    }

    #[test]
    fn a_flat_list_goes_in_and_comes_out() {
        let device = device().unwrap();
        let module = with_parameters(small(), &ramp(), &device).unwrap();
        let tensors = named_parameters(&module).unwrap();
        let names: Vec<&str> = tensors.iter().map(|tensor| tensor.name.as_str()).collect();
        let expected = [
            "layers.0.weight",
            "layers.0.bias",
            "layers.1.weight",
            "layers.1.bias",
            "norm.gamma",
            "norm.beta",
        ];
        assert_eq!(names, expected);
        let flat: Vec<f64> = tensors.into_iter().flat_map(|tensor| tensor.values).collect();
        assert_eq!(flat, ramp());
    }

    #[test]
    fn a_list_of_another_length_is_refused() {
        let device = device().unwrap();
        for (count, message) in [
            (18, "the tensor library: 18 parameters for a network of 19"),
            (20, "the tensor library: 20 parameters for a network of 19"),
            (0, "the tensor library: 0 parameters for a network of 19"),
        ] {
            let error = with_parameters(small(), &vec![0.5; count], &device).unwrap_err();
            assert_eq!(error.to_string(), message);
        }
    }

    #[test]
    fn gradients_come_in_the_order_of_the_list() {
        let recording = device().unwrap().autodiff();
        let module = with_parameters(small(), &ramp(), &recording).unwrap();
        // f = x·W + c of the first layer, summed: ∂f/∂W = x for every output, ∂f/∂c = 1.
        let sum = module.layers[0].forward(tensor(vec![2.0, 5.0], [1, 2], &recording)).sum();
        let gradient = flat_gradient(&module, &sum.backward()).unwrap();
        assert_eq!(gradient[..9], [2.0, 2.0, 2.0, 5.0, 5.0, 5.0, 1.0, 1.0, 1.0]);
        // f does not depend on the other parameters.
        assert_eq!(gradient[9..], [0.0; 10]);
        // 2·(0.0 + 0.1 + 0.2) from the first three weights, 5·(0.3 + 0.4 + 0.5) from the next three, and the
        // biases.
        let expected = 2.0 * (0.0 + 0.1 + 0.2) + 5.0 * (0.3 + 0.4 + 0.5) + (0.6 + 0.7 + 0.8);
        assert!((values(sum).unwrap()[0] - expected).abs() < 1e-13);
    }
}
