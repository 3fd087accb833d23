//! Nonlinear least squares: solver, stopping rules, restarts of start states, and the recalibrated simulator.

pub(crate) mod calibrate;
pub(crate) mod fitted;
pub(crate) mod knots;
pub(crate) mod levenberg_marquardt;
pub(crate) mod normal_equations;
pub(crate) mod restart;
pub(crate) mod significance;
pub(crate) mod stopping;
