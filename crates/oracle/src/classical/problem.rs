//! The problems that the iterative routes take, and what they give back.

use super::Reached;

/// Minimize Σ rᵢ(x)², with the derivatives of r.
pub trait LeastSquaresProblem {
    /// Residuals r, as many at any parameters, at least as many as parameters.
    fn residuals(&self, parameters: &[f64]) -> Vec<f64>;

    /// Columns of the Jacobian: entry i of column j is ∂rᵢ/∂xⱼ.
    fn jacobian(&self, parameters: &[f64]) -> Vec<Vec<f64>>;

    /// Euclidean length of the data that the residuals are differences to: their rounding errors are a
    /// few 10⁻¹⁶ of it. 0 where there are none.
    fn data_length(&self) -> f64 {
        0.0
    }
}

/// Minimize a smooth function.
pub trait SmoothFunction {
    /// The function and its gradient.
    fn value_and_gradient(&self, parameters: &[f64]) -> (f64, Vec<f64>);

    /// Size of a gradient in units that do not depend on those of the function or the parameters: for a
    /// sum of squares the largest |cos| of the angles between the residuals and the Jacobian's columns.
    fn relative_gradient(&self, parameters: &[f64], gradient: &[f64]) -> f64;
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Relative size of what is left to gain at which the search has converged: of the orthogonality or
    /// the gradient, as the method says.
    pub tolerance: f64,
    /// Steps tried at most.
    pub max_steps: u64,
}

/// Where a search for the least squares ended.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastSquaresSolution {
    /// Parameters.
    pub parameters: Vec<f64>,
    /// Σ rᵢ².
    pub sum_of_squares: f64,
    /// Standard errors of the parameters under independent residuals of one variance, the model taken
    /// as linear within them; `None` where rows do not exceed parameters, or the Jacobian is singular.
    pub std_errors: Option<Vec<f64>>,
    /// Length of the residuals' projection on the tangent space of the free parameters, over the
    /// residuals' length (Bates and Watts's relative offset, up to degrees of freedom).
    pub orthogonality: f64,
    /// Two-norm condition number of the Jacobian with columns scaled to length one.
    pub condition: f64,
    /// Steps tried.
    pub steps: u64,
    /// What was reached.
    pub reached: Reached,
    /// Why it stopped there.
    pub because: String,
}

/// Where a search for the minimum of a function ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// Parameters.
    pub parameters: Vec<f64>,
    /// The function there.
    pub value: f64,
    /// Relative size of the gradient there, as the function defines it.
    pub relative_gradient: f64,
    /// Steps taken.
    pub steps: u64,
    /// What was reached.
    pub reached: Reached,
    /// Why it stopped there.
    pub because: String,
}
