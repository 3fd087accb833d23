//! What an optimizer tells while it works and when it stops.

use nalgebra::DVector;

/// State after a step.
#[derive(Debug, Clone, Copy)]
pub struct Iteration<'a> {
    /// Steps taken so far; 0 is the start.
    pub step: u64,
    /// The parameters in force.
    pub parameters: &'a DVector<f64>,
    /// Their loss.
    pub loss: f64,
}

/// Why an optimizer stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// The method's own tolerance holds.
    Settled,
    /// No step lowers the loss or the gradient any more: rounding has the last word.
    Stationary,
    /// The steps are used up.
    StepsSpent,
    /// The loss is not finite.
    NotFinite,
    /// The observer asked to stop.
    Interrupted,
}

/// Where an optimizer stopped.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The best parameters met.
    pub parameters: DVector<f64>,
    /// Their loss.
    pub loss: f64,
    /// The share of the loss that the last accepted step took off; infinite before there was one.
    pub last_gain: f64,
    /// Steps taken.
    pub steps: u64,
    /// Why it stopped.
    pub reason: StopReason,
}
