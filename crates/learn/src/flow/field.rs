//! Laws of motion with weights.

use crate::Place;

/// Derivatives of an acceleration.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Slope {
    /// With respect to the position.
    pub position: f64,
    /// With respect to the velocity.
    pub velocity: f64,
    /// With respect to each weight.
    pub weights: Vec<f64>,
}

/// Acceleration as a function of the state, with weights.
///
/// It is smooth between reversals of the velocity; terms that depend on the sign of the velocity use
/// `direction`.
pub trait Field: Send + Sync {
    /// Returns the number of weights.
    fn weights(&self) -> usize;

    /// Returns `true` if the acceleration depends on the direction of motion; reversals are then events.
    fn is_directed(&self) -> bool;

    /// Returns the acceleration at a state.
    fn acceleration(&self, weights: &[f64], place: &Place) -> f64;

    /// Returns the acceleration and writes its derivatives; `slope.weights` has one entry per weight, and all
    /// are overwritten.
    fn sloped(&self, weights: &[f64], place: &Place, slope: &mut Slope) -> f64;
}
