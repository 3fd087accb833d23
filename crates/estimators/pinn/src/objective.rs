//! Loss as a sum of squares.

use burn::tensor::Device;
use estimator::FitError;
use nalgebra::{DMatrix, DVector};
use neural::{AffineSkipNetwork, LeastSquares, Linearized, Of, PlainNetwork};

/// Loss: mean over the peaks of (f(sᵢ) − zᵢ)² + w · mean over the collocation points of (f′(σⱼ) + λ)², in
/// scaled units. The parameters are those of the network, then λ.
pub(crate) struct Objective<'a> {
    pub(crate) hidden: &'a [usize],
    pub(crate) device: &'a Device,
    pub(crate) times: &'a [f64],
    pub(crate) targets: &'a [f64],
    pub(crate) collocation: &'a [f64],
    pub(crate) physics_weight: f64,
    /// `true` if the network's layers are held at zero: an ablation.
    pub(crate) network_at_zero: bool,
}

/// Number of parameters outside the network's layers, the last ones: a and b of its skip, and λ.
pub(crate) const BESIDE: usize = 3;

/// Ridge of the linear parameters' step, as a share of the largest diagonal entry. Hidden units that are
/// nearly equal leave the normal matrix singular to rounding.
const RIDGE: f64 = 1e-13;

/// Returns λ, and the network's parameters.
fn split(parameters: &DVector<f64>) -> Result<(f64, &[f64]), FitError> {
    let none = || FitError::Backend { problem: "no parameters".to_owned() };
    parameters.as_slice().split_last().map(|(rate, weights)| (*rate, weights)).ok_or_else(none)
}

impl Objective<'_> {
    /// Returns the network and λ of a parameter vector.
    pub(crate) fn model(&self, parameters: &DVector<f64>) -> Result<(AffineSkipNetwork, f64), FitError> {
        let (rate, weights) = split(parameters)?;
        Ok((AffineSkipNetwork::from_parameters(self.hidden, weights, self.device)?, rate))
    }

    /// Returns the same on plain matrices, for training.
    fn plain(&self, parameters: &DVector<f64>) -> Result<(PlainNetwork, f64), FitError> {
        let (rate, weights) = split(parameters)?;
        Ok((PlainNetwork::new(self.hidden, weights)?, rate))
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
        let (network, rate) = self.plain(parameters)?;
        let (fitted, slopes) =
            (network.at(Of::Value, self.times), network.at(Of::Derivative, self.collocation));
        Ok(self.assemble(&fitted, &slopes, rate))
    }

    fn linearize(&self, parameters: &DVector<f64>) -> Result<Linearized, FitError> {
        let (network, rate) = self.plain(parameters)?;
        let (above, below) = (self.times.len(), self.collocation.len());
        let weights = parameters.len() - 1;
        let mut jacobian = DMatrix::zeros(above + below, weights + 1);
        let part = jacobian.view_mut((0, 0), (above, weights));
        let fitted = network.linearize(Of::Value, self.times, self.data_scale(), part);
        let part = jacobian.view_mut((above, 0), (below, weights));
        let slopes = network.linearize(Of::Derivative, self.collocation, self.physics_scale(), part);
        jacobian.view_mut((above, weights), (below, 1)).fill(self.physics_scale());
        if self.network_at_zero {
            // A parameter without a derivative keeps its value.
            jacobian.columns_mut(0, (weights + 1).saturating_sub(BESIDE)).fill(0.0);
        }
        Ok(Linearized { residuals: self.assemble(&fitted, &slopes, rate), jacobian })
    }

    /// Updates the last layer's weights, which enter linearly: they take the step that minimizes the loss,
    /// with all other parameters held. The line beside the network and λ are trained instead: if this step
    /// included them, nothing would be left to train.
    fn project(&self, mut parameters: DVector<f64>) -> Result<DVector<f64>, FitError> {
        if self.network_at_zero {
            return Ok(parameters);
        }
        let residuals = self.residuals(&parameters)?;
        let (network, _) = self.plain(&parameters)?;
        let (values, slopes) = (
            network.last_hidden(Of::Value, self.times) * self.data_scale(),
            network.last_hidden(Of::Derivative, self.collocation) * self.physics_scale(),
        );
        let (above, below, width) = (values.nrows(), slopes.nrows(), values.ncols());
        let mut basis = DMatrix::zeros(above + below, width);
        basis.view_mut((0, 0), values.shape()).copy_from(&values);
        basis.view_mut((above, 0), slopes.shape()).copy_from(&slopes);
        let mut normal = basis.tr_mul(&basis);
        let ridge = RIDGE * normal.diagonal().max();
        normal.iter_mut().step_by(width + 1).for_each(|entry| *entry += ridge);
        if let Some(factor) = normal.cholesky() {
            let step = factor.solve(&basis.tr_mul(&residuals));
            let held = parameters.len() - BESIDE;
            let last = parameters.rows_mut(held - width - 1, width);
            last.into_iter().zip(step.iter()).for_each(|(weight, step)| *weight -= step);
        }
        Ok(parameters)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand::rngs::StdRng;

    /// After the projection the loss is flat along the linear parameters, and the layers below are unchanged.
    #[test]
    fn a_projection_flattens_the_loss_along_the_linear_parameters_and_moves_no_other() {
        let times: Vec<f64> = (0..30).map(|at| f64::from(at) / 14.5 - 1.0).collect();
        let targets: Vec<f64> = times.iter().map(|time| (3.0 * time).sin() - 1.7 * time).collect();
        let hidden = [5, 4];
        let objective = Objective {
            hidden: &hidden,
            device: &neural::device().unwrap(),
            times: &times,
            targets: &targets,
            collocation: &times,
            physics_weight: 10.0,
            network_at_zero: false,
        };
        let mut start = AffineSkipNetwork::draw_parameters(&hidden, 1.0, &mut StdRng::seed_from_u64(3));
        start.push(0.2);
        let start = DVector::from_vec(start);
        let gradient = |at: &DVector<f64>| {
            let Linearized { residuals, jacobian } = objective.linearize(at).unwrap();
            (residuals.norm_squared(), jacobian.tr_mul(&residuals))
        };
        let projected = objective.project(start.clone()).unwrap();
        let ((before, steep), (after, flat)) = (gradient(&start), gradient(&projected));
        // The last layer's four weights; after them come its bias, a, b and λ.
        let linear = start.len() - 8;
        assert_eq!(projected.rows(0, linear), start.rows(0, linear));
        assert_eq!(projected.rows(linear + 4, 4), start.rows(linear + 4, 4));
        let [steep, flat] = [steep, flat].map(|gradient| gradient.rows(linear, 4).norm());
        assert!(after < before && flat < 1e-6 * steep, "{before} {after} {steep} {flat}");
    }
}
