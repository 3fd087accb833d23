//! Progress and results of an optimizer.

use nalgebra::DVector;

/// State of an optimizer after a step.
#[derive(Debug, Clone, Copy)]
pub struct Iteration<'a> {
    /// Number of steps so far; 0 is the start.
    pub step: u64,
    /// Current parameters.
    pub parameters: &'a DVector<f64>,
    /// Loss of the parameters.
    pub loss: f64,
}

/// Reason why an optimizer stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// The method's own tolerance was reached.
    Settled,
    /// No step lowers the loss or the gradient any further: rounding errors dominate.
    Stationary,
    /// The budget of steps is used up.
    StepsSpent,
    /// The loss is not finite.
    NotFinite,
    /// The observer asked to stop.
    Interrupted,
}

/// Result of an optimizer.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// Best parameters found.
    pub parameters: DVector<f64>,
    /// Loss of the parameters.
    pub loss: f64,
    /// Relative decrease of the loss by the last accepted step; infinite if there was none.
    pub last_gain: f64,
    /// Number of steps taken.
    pub steps: u64,
    /// Reason for stopping.
    pub reason: StopReason,
}
