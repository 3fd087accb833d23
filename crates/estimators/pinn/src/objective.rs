//! The loss as a sum of squares.

use burn::tensor::Device;
use estimator::FitError;
use nalgebra::{DMatrix, DVector};
use neural::{AffineSkipNetwork, LeastSquares, Linearized, tensor, values};

/// mean over the peaks of (f(sᵢ) − zᵢ)² + w · mean over the collocation points of (f′(σⱼ) + λ)², in
/// scaled units. Parameters: those of the network, then λ.
pub(crate) struct Objective<'a> {
    pub(crate) hidden: &'a [usize],
    pub(crate) device: &'a Device,
    pub(crate) times: &'a [f64],
    pub(crate) targets: &'a [f64],
    pub(crate) collocation: &'a [f64],
    pub(crate) physics_weight: f64,
}

impl Objective<'_> {
    /// The network and λ of a parameter vector.
    pub(crate) fn model(&self, parameters: &DVector<f64>) -> Result<(AffineSkipNetwork, f64), FitError> {
        let (rate, weights) = parameters
            .as_slice()
            .split_last()
            .ok_or_else(|| FitError::Backend { problem: "no parameters".to_owned() })?;
        let network = AffineSkipNetwork::from_parameters(self.hidden, weights, self.device)?;
        Ok((network, *rate))
    }

    fn data_scale(&self) -> f64 {
        1.0 / (self.times.len() as f64).sqrt()
    }

    fn physics_scale(&self) -> f64 {
        (self.physics_weight / self.collocation.len() as f64).sqrt()
    }

    fn assemble(&self, fitted: &[f64], slopes: &[f64], rate: f64) -> DVector<f64> {
        let data = fitted.iter().zip(self.targets).map(|(f, z)| (f - z) * self.data_scale());
        let physics = slopes.iter().map(|slope| (slope + rate) * self.physics_scale());
        DVector::from_iterator(fitted.len() + slopes.len(), data.chain(physics))
    }
}

impl LeastSquares for Objective<'_> {
    type Error = FitError;

    fn residuals(&self, parameters: &DVector<f64>) -> Result<DVector<f64>, FitError> {
        let (network, rate) = self.model(parameters)?;
        let column = |points: &[f64]| tensor(points.to_vec(), [points.len(), 1], self.device);
        let fitted = values(network.forward(&column(self.times)))?;
        let (_, slopes) = network.forward_with_derivative(&column(self.collocation));
        Ok(self.assemble(&fitted, &values(slopes)?, rate))
    }

    fn linearize(&self, parameters: &DVector<f64>) -> Result<Linearized, FitError> {
        let (network, rate) = self.model(parameters)?;
        let data = network.linearize_values(self.times, self.device)?;
        let physics = network.linearize_derivatives(self.collocation, self.device)?;
        let (rows, columns) = (self.times.len() + self.collocation.len(), parameters.len());
        let mut jacobian = DMatrix::zeros(rows, columns);
        let weights = columns - 1;
        jacobian
            .view_mut((0, 0), (self.times.len(), weights))
            .copy_from(&(data.jacobian * self.data_scale()));
        let below = self.times.len();
        jacobian
            .view_mut((below, 0), (self.collocation.len(), weights))
            .copy_from(&(physics.jacobian * self.physics_scale()));
        jacobian.view_mut((below, weights), (self.collocation.len(), 1)).fill(self.physics_scale());
        let residuals = self.assemble(&data.values, &physics.values, rate);
        Ok(Linearized { residuals, jacobian })
    }
}
