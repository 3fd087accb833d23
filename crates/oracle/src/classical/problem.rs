//! Problems that the iterative routes take, and their solutions.

use super::Reached;

/// Problem of minimizing Σ rᵢ(x)², with the derivatives of r.
pub trait LeastSquaresProblem {
    /// Returns the residuals r. Their number is the same at all parameters, and at least the number of
    /// parameters.
    fn residuals(&self, parameters: &[f64]) -> Vec<f64>;

    /// Returns the columns of the Jacobian: entry i of column j is ∂rᵢ/∂xⱼ.
    fn jacobian(&self, parameters: &[f64]) -> Vec<Vec<f64>>;

    /// Returns the Euclidean length of the data that the residuals are differences to: their rounding errors
    /// are a few 10⁻¹⁶ of it. 0 if there are no such data, which is the default.
    fn data_length(&self) -> f64 {
        0.0
    }
}

/// Smooth function to be minimized.
pub trait SmoothFunction {
    /// Returns the function and its gradient.
    fn value_and_gradient(&self, parameters: &[f64]) -> (f64, Vec<f64>);

    /// Returns the size of a gradient in units that do not depend on those of the function or the parameters:
    /// for a sum of squares, the largest |cos| of the angles between the residuals and the Jacobian's
    /// columns.
    fn relative_gradient(&self, parameters: &[f64], gradient: &[f64]) -> f64;
}

/// Stopping criteria of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Relative orthogonality or relative gradient at which the search has converged, depending on the
    /// method.
    pub tolerance: f64,
    /// Largest number of steps tried.
    pub max_steps: u64,
}

/// Result of a least-squares search.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastSquaresSolution {
    /// Parameters.
    pub parameters: Vec<f64>,
    /// Sum of squares, Σ rᵢ².
    pub sum_of_squares: f64,
    /// Standard errors of the parameters for independent residuals of one variance, with the model taken as
    /// linear within them; `None` if there are no more rows than parameters or the Jacobian is singular.
    pub std_errors: Option<Vec<f64>>,
    /// Length of the residuals' projection on the tangent space of the free parameters, over the length of
    /// the residuals (the relative offset of Bates and Watts, up to degrees of freedom).
    pub orthogonality: f64,
    /// Two-norm condition number of the Jacobian with columns scaled to length one.
    pub condition: f64,
    /// Number of steps tried.
    pub steps: u64,
    /// State in which the search ended.
    pub reached: Reached,
    /// Reason why the search ended, as a sentence with numbers.
    pub because: String,
}

/// Result of a search for the minimum of a function.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// Parameters.
    pub parameters: Vec<f64>,
    /// Function at the parameters.
    pub value: f64,
    /// Relative size of the gradient there, as defined by the function.
    pub relative_gradient: f64,
    /// Number of steps taken.
    pub steps: u64,
    /// State in which the search ended.
    pub reached: Reached,
    /// Reason why the search ended, as a sentence with numbers.
    pub because: String,
}
