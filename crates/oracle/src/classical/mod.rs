//! The paper's eleven classical methods, each with its own arithmetic.
//!
//! All eleven minimize Σ(ln A₀ − λ·t − ln A)². They differ in the algorithm, and so in the number of digits
//! that they keep: [`CLASSICAL`] lists them in the paper's order. The linear ones take any design matrix and
//! state how many digits they promise. The iterative ones take any problem that implements
//! [`LeastSquaresProblem`] or [`SmoothFunction`] and state what they reached. None of them uses
//! [`crate::least_squares`], against which they are measured.

mod jacobi;
mod line;
mod linear;
mod local;
#[cfg(test)]
mod nist;
mod prediction;
mod problem;
mod reflection;
mod route;
#[cfg(test)]
mod tests;
mod vectors;

pub mod differential_evolution;
pub mod gradient_descent;
pub mod l_bfgs;
pub mod levenberg_marquardt;
pub mod normal_equations;
pub mod ols;
pub mod polynomial_fit;
pub mod qr;
pub mod svd;
pub mod trust_region;
pub mod weighted_regression;

pub use linear::LinearSolution;
pub use prediction::LinePrediction;
pub use problem::{LeastSquaresProblem, LeastSquaresSolution, Limits, Minimum, SmoothFunction};
pub use route::{ClassicalFit, ClassicalRoute, Reached};

/// Classical methods of the paper, by number.
pub const CLASSICAL: &[ClassicalRoute] = &[
    ols::ROUTE,
    polynomial_fit::ROUTE,
    normal_equations::ROUTE,
    qr::ROUTE,
    svd::ROUTE,
    gradient_descent::ROUTE,
    l_bfgs::ROUTE,
    differential_evolution::ROUTE,
    levenberg_marquardt::ROUTE,
    trust_region::ROUTE,
    weighted_regression::ROUTE,
];
