//! Line with Gaussian scatter: its prior, and its posterior in closed form.

use crate::nuts::{LogDensity, Point};
use nalgebra::Vector3;

/// Prior of (u, r, σ²): the value at the first peak, the decay rate and the variance of the scatter, in
/// scaled units. Given σ², u and r are independent and normal about zero with variance κ²σ² each; σ² is
/// inverse-gamma with shape a₀ and rate b₀.
///
/// With shape −1 and rate 0 it is improper in σ². A normal prior whose width is proportional to σ contributes
/// a factor 1/σ for either coefficient, and shape −1 cancels both. So for large κ the posterior is that of
/// the reference prior p(u, r, σ²) ∝ 1/σ², whose intervals have the stated coverage.
///
/// Reference: Gelman, Carlin, Stern, Dunson, Vehtari, Rubin, Bayesian Data Analysis, 3rd ed. (2013),
/// sections 3.3, 14.2 and 14.8.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Prior {
    /// Width κ: standard deviation of u and r in units of σ.
    pub(crate) width: f64,
    /// Shape a₀.
    pub(crate) noise_shape: f64,
    /// Rate b₀, in scaled units squared.
    pub(crate) noise_rate: f64,
}

/// Sufficient statistics of the data: the triangular factor of the columns 1, −τ, z. With it the sum of
/// squares is
///
/// D(u, r) = (y₁ − c₁₁u − c₁₂r)² + (y₂ − c₂₂r)² + y₃²
///
/// for any number of peaks, without the cancellation that sums of products would suffer if there is little
/// scatter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Statistics {
    count: f64,
    c11: f64,
    c12: f64,
    c22: f64,
    y1: f64,
    y2: f64,
    y3: f64,
}

impl Statistics {
    /// Reduces times τ and values z, of equal number, by the modified Gram–Schmidt method.
    pub(crate) fn new(times: &[f64], values: &[f64]) -> Self {
        let count = times.len() as f64;
        let c11 = count.sqrt();
        let mean_time = times.iter().sum::<f64>() / count;
        let mean_value = values.iter().sum::<f64>() / count;
        let column = || times.iter().map(|time| mean_time - time);
        let c22 = column().map(|x| x * x).sum::<f64>().sqrt();
        let y2 = column().zip(values).map(|(x, z)| x * (z - mean_value)).sum::<f64>() / c22;
        let rest = column().zip(values).map(|(x, z)| (z - mean_value - y2 / c22 * x).powi(2));
        let y3 = rest.sum::<f64>().sqrt();
        Self { count, c11, c12: -mean_time * c11, c22, y1: mean_value * c11, y2, y3 }
    }

    /// Returns the determinant of V⁻¹ = XᵀX + `precision`.
    fn determinant(&self, precision: f64) -> f64 {
        let Self { c11, c12, c22, .. } = *self;
        (c11 * c22).powi(2) + precision * (c11 * c11 + c12 * c12 + c22 * c22) + precision * precision
    }
}

/// Prior and data together: the log posterior density of (u, r, ℓ) with ℓ = ln σ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Model {
    pub(crate) prior: Prior,
    pub(crate) statistics: Statistics,
}

impl LogDensity for Model {
    /// Evaluates −(N + 2 + 2a₀)·ℓ − e^(−2ℓ)·(b₀ + ½·D(u, r) + ½·(u² + r²)/κ²), up to a constant, including
    /// the Jacobian of the change from σ² to ℓ.
    fn at(&self, position: Vector3<f64>) -> Point {
        let Statistics { count, c11, c12, c22, y1, y2, y3 } = self.statistics;
        let Prior { width, noise_shape, noise_rate } = self.prior;
        let [u, r, log_sigma] = position.into();
        let precision = 1.0 / (width * width);
        let (first, second) = (y1 - c11 * u - c12 * r, y2 - c22 * r);
        let squares = first * first + second * second + y3 * y3 + precision * (u * u + r * r);
        let weight = (-2.0 * log_sigma).exp();
        let inner = noise_rate + 0.5 * squares;
        let power = count + 2.0 + 2.0 * noise_shape;
        Point {
            position,
            log_density: -power * log_sigma - weight * inner,
            gradient: Vector3::new(
                weight * (c11 * first - precision * u),
                weight * (c12 * first + c22 * second - precision * r),
                2.0 * weight * inner - power,
            ),
        }
    }
}

/// Posterior in closed form. Given σ², (u, r) is normal about `mean` with covariance σ²·V; σ² is
/// inverse-gamma. So r alone has Student's t distribution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Conjugate {
    /// Posterior mean of u, the value at the first peak.
    pub(crate) start: f64,
    /// Posterior mean of r, the decay rate.
    pub(crate) rate: f64,
    /// Scale of the Student's t of r, √(b/a · V_rr).
    pub(crate) rate_scale: f64,
    /// Degrees of freedom of that distribution, 2a = N + 2a₀.
    pub(crate) degrees_of_freedom: f64,
    /// Standard deviation of the scatter, √(b/a).
    pub(crate) scatter: f64,
    statistics: Statistics,
    /// Prior precision 1/κ².
    precision: f64,
}

impl Conjugate {
    /// Returns the standard deviation of a new value at a time τ. The new value has Student's t distribution
    /// about u − rτ with the scale √(b/a · (1 + xᵀVx)), x = (1, −τ). Its standard deviation is √(ν/(ν − 2))
    /// times the scale; `None` for ν ≤ 2 degrees of freedom.
    ///
    /// Reference: Gelman et al. (2013), section 14.3.
    pub(crate) fn predictive_deviation(&self, time: f64) -> Option<f64> {
        let Statistics { c11, c12, c22, .. } = self.statistics;
        // The form xᵀVx as a sum of squares.
        let leverage = (c11 * time + c12).powi(2) + c22 * c22 + self.precision * (1.0 + time * time);
        let share = leverage / self.statistics.determinant(self.precision);
        let freedom = self.degrees_of_freedom;
        (freedom > 2.0).then(|| self.scatter * (freedom / (freedom - 2.0) * (1.0 + share)).sqrt())
    }
}

impl Model {
    /// Computes V⁻¹ = XᵀX + 1/κ², mean = V·Xᵀz, a = a₀ + N/2 and b = b₀ + ½·(‖z − X·mean‖² + ‖mean‖²/κ²),
    /// where X has the columns 1 and −τ.
    ///
    /// Reference: Gelman et al. (2013), section 14.8; b is in the form without cancellation.
    pub(crate) fn conjugate(&self) -> Conjugate {
        let Statistics { count, c11, c12, c22, y1, y2, .. } = self.statistics;
        let precision = 1.0 / (self.prior.width * self.prior.width);
        // The two-by-two system is written out, and the terms that cancel are removed analytically.
        let determinant = self.statistics.determinant(precision);
        let start = c11 * (c22 * (c22 * y1 - c12 * y2) + precision * y1) / determinant;
        let rate = (c11 * c11 * c22 * y2 + precision * (c12 * y1 + c22 * y2)) / determinant;
        let shape = self.prior.noise_shape + count / 2.0;
        let rate_variance = (c11 * c11 + precision) / determinant;
        let variance = self.misfit(start, rate) / shape;
        Conjugate {
            start,
            rate,
            rate_scale: (variance * rate_variance).sqrt(),
            degrees_of_freedom: 2.0 * shape,
            scatter: variance.sqrt(),
            statistics: self.statistics,
            precision,
        }
    }

    /// Returns b₀ + ½·(D(u, r) + (u² + r²)/κ²).
    fn misfit(&self, u: f64, r: f64) -> f64 {
        let Statistics { c11, c12, c22, y1, y2, y3, .. } = self.statistics;
        let squares = (y1 - c11 * u - c12 * r).powi(2) + (y2 - c22 * r).powi(2) + y3 * y3;
        self.prior.noise_rate + 0.5 * (squares + (u * u + r * r) / self.prior.width.powi(2))
    }
}

#[cfg(test)]
mod tests {
    use super::{Model, Prior, Statistics};
    use crate::nuts::LogDensity;
    use nalgebra::{DMatrix, DVector, Vector3};

    const TIMES: [f64; 6] = [0.0, 0.1, 0.35, 0.5, 0.8, 1.0];
    const VALUES: [f64; 6] = [1.3, 1.2, 0.4, 0.1, -1.0, -2.0];

    fn model(prior: Prior) -> Model {
        Model { prior, statistics: Statistics::new(&TIMES, &VALUES) }
    }

    /// Prior that is narrow enough to have an effect.
    const TIGHT: Prior = Prior { width: 2.0, noise_shape: 1.5, noise_rate: 0.3 };

    /// Computes the log posterior from its definition: scatter, prior of the coefficients, inverse-gamma,
    /// Jacobian.
    fn by_definition(prior: Prior, u: f64, r: f64, log_sigma: f64) -> f64 {
        let normal = |x: f64, sd: f64| -0.5 * (x / sd).powi(2) - sd.ln();
        let sigma = log_sigma.exp();
        let data: f64 = TIMES.iter().zip(VALUES).map(|(t, z)| normal(z - (u - r * t), sigma)).sum();
        let coefficients = normal(u, prior.width * sigma) + normal(r, prior.width * sigma);
        let variance = sigma * sigma;
        let noise = -(prior.noise_shape + 1.0) * variance.ln() - prior.noise_rate / variance;
        data + coefficients + noise + variance.ln()
    }

    #[test]
    fn the_density_is_that_of_its_definition() {
        let one = Vector3::new(0.3, 2.0, -0.4);
        let other = Vector3::new(1.1, -0.7, 0.9);
        let ours = model(TIGHT).at(one).log_density - model(TIGHT).at(other).log_density;
        let theirs = by_definition(TIGHT, 0.3, 2.0, -0.4) - by_definition(TIGHT, 1.1, -0.7, 0.9);
        assert!((ours - theirs).abs() < 1e-12, "{ours} {theirs}");
    }

    #[test]
    fn the_gradient_is_that_of_the_density() {
        let model = model(TIGHT);
        let at = Vector3::new(0.3, 2.0, -0.4);
        for axis in 0..3 {
            let mut step = Vector3::zeros();
            step[axis] = 1e-6;
            let slope = (model.at(at + step).log_density - model.at(at - step).log_density) / 2e-6;
            assert!((slope - model.at(at).gradient[axis]).abs() < 1e-6, "{axis}");
        }
    }

    #[test]
    fn the_closed_form_is_that_of_its_matrices() {
        let x = DMatrix::from_fn(6, 2, |row, column| if column == 0 { 1.0 } else { -TIMES[row] });
        let z = DVector::from_row_slice(&VALUES);
        let precision = x.tr_mul(&x) + DMatrix::identity(2, 2) / TIGHT.width.powi(2);
        let covariance = precision.clone().try_inverse().unwrap();
        let mean = &covariance * x.tr_mul(&z);
        let shape = TIGHT.noise_shape + 3.0;
        // The textbook's form of b, which differs from ours.
        let rate = TIGHT.noise_rate + 0.5 * (z.norm_squared() - mean.dot(&(&precision * &mean)));
        let found = model(TIGHT).conjugate();
        assert!((found.start - mean[0]).abs() < 1e-13);
        assert!((found.rate - mean[1]).abs() < 1e-13);
        assert!((found.degrees_of_freedom - 2.0 * shape).abs() < 1e-13);
        assert!((found.scatter - (rate / shape).sqrt()).abs() < 1e-13);
        assert!((found.rate_scale - (rate / shape * covariance[(1, 1)]).sqrt()).abs() < 1e-13);
    }

    #[test]
    fn the_predictive_deviation_is_that_of_its_definition() {
        let posterior = model(TIGHT).conjugate();
        let design = DMatrix::from_fn(6, 2, |row, column| if column == 0 { 1.0 } else { -TIMES[row] });
        let covariance = (design.tr_mul(&design) + DMatrix::identity(2, 2) / 4.0).try_inverse().unwrap();
        for time in [-0.5, 0.0, 0.4, 3.0] {
            let x = DVector::from_vec(vec![1.0, -time]);
            let scale = posterior.scatter * (1.0 + x.dot(&(&covariance * &x))).sqrt();
            // There are 2a = 6 + 2·1.5 = 9 degrees of freedom.
            let expected = scale * (9.0_f64 / 7.0).sqrt();
            assert!((posterior.predictive_deviation(time).unwrap() / expected - 1.0).abs() < 1e-13, "{time}");
        }
    }

    #[test]
    fn the_prior_pulls_as_documented() {
        // 69 even peaks on a steep line: relative shifts of 2e-3, 2e-5 and 2e-11 for three widths.
        let times: Vec<f64> = (0..69).map(|i| f64::from(i) / 68.0).collect();
        let values: Vec<f64> = times.iter().map(|t| 1.7 - 3.4 * t).collect();
        let statistics = Statistics::new(&times, &values);
        for (width, pull) in [(10.0, 2.2e-3), (100.0, 2.2e-5), (1e5, 2.2e-11)] {
            let prior = Prior { width, noise_shape: -1.0, noise_rate: 0.0 };
            let off = 1.0 - Model { prior, statistics }.conjugate().rate / 3.4;
            assert!((off / pull - 1.0).abs() < 0.1, "{width}: {off:e}");
        }
    }

    #[test]
    fn with_the_default_prior_it_is_the_reference_posterior() {
        let found = model(Prior { width: 1e5, noise_shape: -1.0, noise_rate: 0.0 }).conjugate();
        assert!((found.degrees_of_freedom - 4.0).abs() < 1e-13);
        let (mt, mz) = (TIMES.iter().sum::<f64>() / 6.0, VALUES.iter().sum::<f64>() / 6.0);
        let sxx: f64 = TIMES.iter().map(|t| (t - mt).powi(2)).sum();
        let slope = TIMES.iter().zip(VALUES).map(|(t, z)| (t - mt) * (z - mz)).sum::<f64>() / sxx;
        let rss: f64 = TIMES.iter().zip(VALUES).map(|(t, z)| (z - mz - slope * (t - mt)).powi(2)).sum();
        assert!((found.rate_scale / (rss / 4.0 / sxx).sqrt() - 1.0).abs() < 1e-7);
    }
}
