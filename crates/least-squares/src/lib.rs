//! Nonlinear least squares by the Levenberg–Marquardt method.
//!
//! A [`Descent`] says after each trial how strongly the next step is damped, and when to stop; its caller solves
//! the damped normal equations in whatever shape they have: dense, or bordered with start states eliminated.
//! [`Method::minimize`] is the whole method for a dense Jacobian, and can be resumed.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod dense;
mod descent;
mod minimum;

pub use dense::{LeastSquares, Linearized, State};
pub use descent::{Descent, Method, gain_ratio, is_rounding};
pub use minimum::{Iteration, Minimum, StopReason};
