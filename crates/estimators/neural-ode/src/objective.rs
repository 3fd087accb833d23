//! Loss as a sum of squares.

use crate::config::NeuralOdeConfig;
use crate::field::VectorField;
use crate::solver::{Place, START, Stage, Trajectory, integrate, march, steps_to};
use burn::tensor::Device;
use estimator::FitError;
use nalgebra::{DMatrix, DVector};
use neural::{LeastSquares, Linearized};
use std::cell::RefCell;
use std::rc::Rc;

/// Loss: mean over the peaks of (y(sᵢ) − zᵢ)² + w · mean over the half steps of (y″)² + d · Σ p², in scaled
/// units. Here y is the numerical solution, w the curvature weight and d the weight decay; the last sum is
/// over the parameters that do not change when a line is added to the trajectory
/// ([`decayed`](VectorField::decayed)). The parameters are those of the field, then the initial state y(−1).
pub(crate) struct Objective<'a> {
    config: &'a NeuralOdeConfig,
    device: &'a Device,
    targets: &'a [f64],
    places: Vec<Place>,
    /// Weight of each peak in the slope of the least-squares line through values at the peaks.
    slope_shares: Vec<f64>,
    decayed: Vec<usize>,
    /// Latest solution. A solution takes hundreds of sequential passes, and an accepted step asks for it
    /// three times.
    latest: RefCell<Option<(DVector<f64>, Rc<Trajectory>)>>,
    /// `true` if the network is held at zero except for its constant part: an ablation.
    network_at_zero: bool,
}

/// Number of parameters outside the network, the last ones: the constant part c and the initial state.
pub(crate) const BESIDE: usize = 2;

/// Trained function at a time.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reading {
    pub(crate) value: f64,
    /// Derivatives of the value by the parameters.
    pub(crate) gradient: DVector<f64>,
}

/// Farthest time from the first peak to which the field is followed, in record lengths.
pub(crate) const LONGEST: f64 = 100.0;

impl<'a> Objective<'a> {
    /// Creates the loss for peaks at scaled times with scaled logarithms.
    pub(crate) fn new(
        config: &'a NeuralOdeConfig,
        device: &'a Device,
        times: &[f64],
        targets: &'a [f64],
        network_at_zero: bool,
    ) -> Self {
        let mean = times.iter().sum::<f64>() / times.len() as f64;
        let squares: f64 = times.iter().map(|time| (time - mean).powi(2)).sum();
        Self {
            config,
            device,
            targets,
            places: times.iter().map(|&time| Place::of(time, config.solver_steps)).collect(),
            slope_shares: times.iter().map(|time| (time - mean) / squares).collect(),
            decayed: VectorField::decayed(&config.hidden),
            latest: RefCell::default(),
            network_at_zero,
        }
    }

    /// Returns the number of peaks.
    pub(crate) fn peaks(&self) -> usize {
        self.targets.len()
    }

    /// Returns the field and the initial state of a parameter vector.
    pub(crate) fn model(&self, parameters: &DVector<f64>) -> Result<(VectorField, f64), FitError> {
        let (initial, weights) = parameters
            .as_slice()
            .split_last()
            .ok_or_else(|| FitError::Backend { problem: "no parameters".to_owned() })?;
        Ok((VectorField::from_parameters(&self.config.hidden, weights, self.device)?, *initial))
    }

    /// Returns the numerical solution.
    fn trajectory(&self, parameters: &DVector<f64>) -> Result<Rc<Trajectory>, FitError> {
        if let Some((of, trajectory)) = &*self.latest.borrow()
            && of == parameters
        {
            return Ok(Rc::clone(trajectory));
        }
        let (field, initial) = self.model(parameters)?;
        let evaluate = |state, time| field.at(state, time, self.device);
        let trajectory = Rc::new(integrate(evaluate, initial, self.config.solver_steps)?);
        self.latest.replace(Some((parameters.clone(), Rc::clone(&trajectory))));
        Ok(trajectory)
    }

    /// Returns the trained function at the peaks.
    pub(crate) fn fitted(&self, parameters: &DVector<f64>) -> Result<Vec<f64>, FitError> {
        Ok(self.at_peaks(&*self.trajectory(parameters)?))
    }

    fn at_peaks(&self, trajectory: &Trajectory) -> Vec<f64> {
        let nodes: Vec<Stage> = trajectory.nodes().copied().collect();
        self.places.iter().map(|place| place.value(&nodes)).collect()
    }

    /// Returns the trained function and its derivatives by the parameters at scaled times in any order. The
    /// field is integrated with the steps of the record, forward beyond its end and backward before its
    /// start. `None` for a time farther than [`LONGEST`] record lengths from the first peak.
    pub(crate) fn readings(
        &self,
        parameters: &DVector<f64>,
        times: &[f64],
    ) -> Result<Vec<Option<Reading>>, FitError> {
        let (field, initial) = self.model(parameters)?;
        let evaluate = |state, time| field.at(state, time, self.device);
        let mut found: Vec<Option<Reading>> = vec![None; times.len()];
        for later in [true, false] {
            let asked = |time: f64| (time >= START) == later && (time - START).abs() <= 2.0 * LONGEST;
            let mine = times.iter().copied().filter(|time| asked(*time));
            let farthest = mine.max_by(|one, other| (one - START).abs().total_cmp(&(other - START).abs()));
            let Some(farthest) = farthest else { continue };
            let (step, count) = steps_to(farthest, self.config.solver_steps);
            let trajectory = march(evaluate, initial, step, count)?;
            let nodes: Vec<Stage> = trajectory.nodes().copied().collect();
            let stages: Vec<[f64; 2]> = trajectory.stages.iter().map(|at| [at.state, at.time]).collect();
            let sensitivities = trajectory.sensitivities(&field.partials(&stages, self.device)?);
            for (entry, &time) in found.iter_mut().zip(times).filter(|(_, time)| asked(**time)) {
                let place = Place::on(time, step, count);
                let gradient = place.sensitivity(&sensitivities);
                *entry = gradient.map(|gradient| Reading { value: place.value(&nodes), gradient });
            }
        }
        Ok(found)
    }

    /// Returns the slope of the least-squares line through values at the peaks.
    pub(crate) fn projected_slope<'b>(&self, values: impl IntoIterator<Item = &'b f64>) -> f64 {
        self.slope_shares.iter().zip(values).map(|(share, value)| share * value).sum()
    }

    /// Returns the derivative of the projected slope, from the rows of the Jacobian that belong to the peaks.
    pub(crate) fn slope_gradient(&self, jacobian: &DMatrix<f64>) -> DVector<f64> {
        let shares = DVector::from_column_slice(&self.slope_shares);
        jacobian.rows(0, self.peaks()).tr_mul(&shares) / self.data_scale()
    }

    /// Returns the factor of the residuals at the peaks.
    pub(crate) fn data_scale(&self) -> f64 {
        1.0 / (self.peaks() as f64).sqrt()
    }

    fn curvature_scale(&self) -> f64 {
        (self.config.curvature_weight / self.half_steps() as f64).sqrt()
    }

    fn decay_scale(&self) -> f64 {
        self.config.weight_decay.sqrt()
    }

    fn half_steps(&self) -> usize {
        2 * self.config.solver_steps
    }

    fn rows(&self) -> usize {
        self.peaks() + self.half_steps() + self.decayed.len()
    }

    fn assemble(&self, trajectory: &Trajectory, parameters: &DVector<f64>) -> DVector<f64> {
        let fitted = self.at_peaks(trajectory);
        let data = fitted.iter().zip(self.targets).map(|(y, z)| (y - z) * self.data_scale());
        let curvature = trajectory.curvatures().map(|bend| bend * self.curvature_scale());
        let decayed = self.decayed.iter().filter_map(|&at| parameters.get(at));
        let decay = decayed.map(|parameter| parameter * self.decay_scale());
        DVector::from_iterator(self.rows(), data.chain(curvature).chain(decay))
    }
}

impl LeastSquares for Objective<'_> {
    type Error = FitError;

    fn residuals(&self, parameters: &DVector<f64>) -> Result<DVector<f64>, FitError> {
        Ok(self.assemble(&*self.trajectory(parameters)?, parameters))
    }

    fn linearize(&self, parameters: &DVector<f64>) -> Result<Linearized, FitError> {
        let trajectory = self.trajectory(parameters)?;
        let (field, _) = self.model(parameters)?;
        // The solver has determined the stages; their derivatives now come from one pass.
        let stages: Vec<[f64; 2]> = trajectory.stages.iter().map(|at| [at.state, at.time]).collect();
        let sensitivities = trajectory.sensitivities(&field.partials(&stages, self.device)?);
        let mut transposed = DMatrix::zeros(parameters.len(), self.rows());
        let data = self.places.iter().map(|place| {
            place.sensitivity(&sensitivities).map_or_else(
                || DVector::from_element(parameters.len(), f64::NAN),
                |row| row * self.data_scale(),
            )
        });
        let curvature = sensitivities.curvatures.iter().map(|row| row * self.curvature_scale());
        for (mut column, row) in transposed.column_iter_mut().zip(data.chain(curvature)) {
            column.copy_from(&row);
        }
        let above = self.peaks() + self.half_steps();
        for (row, &at) in self.decayed.iter().enumerate() {
            if let Some(entry) = transposed.get_mut((at, above + row)) {
                *entry = self.decay_scale();
            }
        }
        if self.network_at_zero {
            // A parameter without a derivative keeps its value.
            transposed.rows_mut(0, parameters.len().saturating_sub(BESIDE)).fill(0.0);
        }
        Ok(Linearized { residuals: self.assemble(&trajectory, parameters), jacobian: transposed.transpose() })
    }
}

#[cfg(test)]
mod tests {
    use super::Objective;
    use crate::config::NeuralOdeConfig;
    use crate::field::VectorField;
    use nalgebra::DVector;
    use neural::{LeastSquares, LevenbergMarquardt, device};
    use seed::Seed;

    const TIMES: &[f64] = &[-1.0, -0.93, -0.4, 0.1, 0.11, 0.7, 1.0];
    const TARGETS: &[f64] = &[1.5, 1.2, 0.3, 0.2, 0.4, -0.9, -1.3];

    fn config() -> NeuralOdeConfig {
        NeuralOdeConfig {
            hidden: vec![4, 3],
            solver_steps: 5,
            curvature_weight: 0.3,
            weight_decay: 0.2,
            training: LevenbergMarquardt { max_steps: 0, loss_tolerance: 0.0 },
            initial_scale: 0.9,
        }
    }

    fn parameters(seed: u64) -> DVector<f64> {
        let mut generator = Seed::new(seed).generator();
        let mut parameters = VectorField::draw_parameters(&config().hidden, 0.9, &mut generator);
        parameters.push(1.3);
        DVector::from_vec(parameters)
    }

    #[test]
    fn the_jacobian_through_the_solver_is_exact() {
        let (device, config, parameters) = (device().unwrap(), config(), parameters(1));
        let objective = Objective::new(&config, &device, TIMES, TARGETS, false);
        let linearized = objective.linearize(&parameters).unwrap();
        assert_eq!(linearized.residuals, objective.residuals(&parameters).unwrap());
        // Weights: 2·4 + 4·3 + 3, biases: 4 + 3 + 1, and the initial state; all but 2·4 + 2 of them decay.
        assert_eq!(linearized.jacobian.shape(), (TIMES.len() + 10 + 22, 32));
        let h = 1e-3;
        for column in 0..parameters.len() {
            let moved = |by: f64| {
                let mut moved = parameters.clone();
                moved[column] += by;
                objective.residuals(&moved).unwrap()
            };
            let expected = ((moved(h) - moved(-h)) * 8.0 - (moved(2.0 * h) - moved(-2.0 * h))) / (12.0 * h);
            let off = (linearized.jacobian.column(column) - expected).amax();
            assert!(off < 1e-10, "column {column}: {off:e}");
        }
    }

    /// y + a + b·s solves the field whose first layer receives y − a − b·s and whose c is larger by b. The
    /// solver reproduces this to rounding, because its stages are consistent: Σⱼ aᵢⱼ = cᵢ.
    #[test]
    fn a_line_added_to_a_trajectory_is_a_change_of_parameters_that_costs_nothing() {
        let (device, config) = (device().unwrap(), config());
        let objective = Objective::new(&config, &device, TIMES, TARGETS, false);
        let (a, b) = (0.4, -0.7);
        let before = parameters(2);
        let mut after = before.clone();
        let (width, count) = (config.hidden[0], before.len());
        for unit in 0..width {
            after[width + unit] -= b * before[unit];
            after[2 * width + unit] -= a * before[unit];
        }
        after[count - 2] += b;
        after[count - 1] += a - b;
        let fitted = |parameters| objective.fitted(parameters).unwrap();
        for ((time, before), after) in TIMES.iter().zip(fitted(&before)).zip(fitted(&after)) {
            assert!((after - before - a - b * time).abs() < 1e-14);
        }
        let rest = |parameters| {
            let residuals = objective.residuals(parameters).unwrap();
            residuals.rows(TIMES.len(), residuals.len() - TIMES.len()).into_owned()
        };
        assert!((rest(&before) - rest(&after)).amax() < 1e-13);
    }

    #[test]
    fn the_projected_slope_of_a_line_is_its_slope() {
        let (device, config) = (device().unwrap(), config());
        let objective = Objective::new(&config, &device, TIMES, TARGETS, false);
        let line: Vec<f64> = TIMES.iter().map(|time| 0.3 - 1.7 * time).collect();
        assert!((objective.projected_slope(&line) + 1.7).abs() < 1e-15);
    }
}
