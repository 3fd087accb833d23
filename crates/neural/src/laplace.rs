//! Laplace approximation about trained parameters.
//!
//! Reference: MacKay, Neural Computation 4 (1992) 448.

use least_squares::Linearized;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Gaussian posterior about parameters that minimize a mean square over the peaks plus prior terms. Its
/// precision is the loss's Gauss–Newton matrix A divided by the residual variance.
#[derive(Debug, Clone)]
pub struct Laplace {
    factor: Cholesky<f64, Dyn>,
    peaks: f64,
    /// Residual variance of a peak, in the units of the residuals.
    variance: f64,
    degrees_of_freedom: f64,
}

impl Laplace {
    /// Computes the approximation at a point.
    ///
    /// The first `peaks` rows of the residuals are those of the peaks, each divided by √peaks; the others are
    /// those of the prior. `degrees_of_freedom` returns the residuals' degrees of freedom, given the number
    /// of peaks and the matrix A⁻¹JᵀJ, where J holds the peaks' rows; the trace of this matrix is the number
    /// of parameters that the peaks determine. `None` if less than one degree of freedom is left, or if A is
    /// not positive definite up to rounding.
    #[must_use]
    pub fn about(
        linearized: &Linearized,
        peaks: usize,
        degrees_of_freedom: impl FnOnce(f64, &DMatrix<f64>) -> f64,
    ) -> Option<Self> {
        let jacobian = &linearized.jacobian;
        let seen = jacobian.tr_mul(jacobian);
        // Directions that neither peaks nor prior determine get a wide prior.
        let wide = DMatrix::from_diagonal_element(seen.nrows(), seen.ncols(), 1e-12 * seen.diagonal().max());
        let factor = Cholesky::new(seen + wide)?;
        let data = jacobian.rows(0, peaks);
        // Only parameters × parameters, however many peaks there are.
        let hat = factor.solve(&data.tr_mul(&data));
        let count = peaks as f64;
        let degrees = degrees_of_freedom(count, &hat);
        // The rows of the peaks carry a factor 1/√peaks, which is undone for a variance per peak.
        let mean_square = linearized.residuals.rows(0, peaks).norm_squared();
        let variance = mean_square * count / degrees;
        (degrees >= 1.0).then_some(Self { factor, peaks: count, variance, degrees_of_freedom: degrees })
    }

    /// Returns the degrees of freedom of the residual variance, at least 1.
    #[must_use]
    pub fn degrees_of_freedom(&self) -> f64 {
        self.degrees_of_freedom
    }

    /// Returns the standard deviation of a quantity with the given derivatives with respect to the
    /// parameters.
    #[must_use]
    pub fn deviation(&self, gradient: &DVector<f64>) -> f64 {
        self.spread(gradient).sqrt()
    }

    /// Returns the standard deviation of a measured value about a function with the given derivatives with
    /// respect to the parameters: the scatter of a peak combined with the error of the function.
    #[must_use]
    pub fn predictive_deviation(&self, gradient: &DVector<f64>) -> f64 {
        (self.variance + self.spread(gradient)).sqrt()
    }

    fn spread(&self, gradient: &DVector<f64>) -> f64 {
        gradient.dot(&self.factor.solve(gradient)) * self.variance / self.peaks
    }
}

#[cfg(test)]
mod tests {
    use super::Laplace;
    use least_squares::Linearized;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn of_a_line_it_is_the_textbook_s() {
        let times = [0.0, 0.1, 0.5, 0.6, 1.0];
        let residuals = [0.3, -0.4, 0.1, 0.05, -0.05];
        let scale = 1.0 / 5.0_f64.sqrt();
        let linearized = Linearized {
            residuals: DVector::from_iterator(5, residuals.iter().map(|r| r * scale)),
            jacobian: DMatrix::from_fn(5, 2, |row, column| scale * [1.0, times[row]][column]),
        };
        let laplace = Laplace::about(&linearized, 5, |peaks, hat| peaks - hat.trace()).unwrap();
        assert!((laplace.degrees_of_freedom() - 3.0).abs() < 1e-9);
        let variance = residuals.iter().map(|r| r * r).sum::<f64>() / 3.0;
        let (mean, scatter) = (0.44, 0.652);
        let slope = laplace.deviation(&DVector::from_vec(vec![0.0, 1.0]));
        assert!((slope - (variance / scatter).sqrt()).abs() < 1e-9);
        for time in [-1.0, 0.3, 2.0] {
            let new = laplace.predictive_deviation(&DVector::from_vec(vec![1.0, time]));
            let expected = (variance * (1.2 + (time - mean) * (time - mean) / scatter)).sqrt();
            assert!((new - expected).abs() < 1e-9, "{time}: {new} {expected}");
        }
        assert!(Laplace::about(&linearized, 5, |_, _| 0.5).is_none());
    }
}
