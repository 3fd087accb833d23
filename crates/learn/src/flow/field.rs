//! A law of motion with weights.

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

/// An acceleration as a function of the state, with weights. Between reversals of the velocity it is smooth; what
/// depends on the sign of the velocity takes `direction`.
pub trait Field: Send + Sync {
    /// Number of weights.
    fn weights(&self) -> usize;

    /// Whether it depends on the direction, so that reversals are events.
    fn is_directed(&self) -> bool;

    /// Acceleration at a place.
    fn acceleration(&self, weights: &[f64], place: &Place) -> f64;

    /// Acceleration with its derivatives; `slope.weights` has one entry for each weight, all overwritten.
    fn sloped(&self, weights: &[f64], place: &Place, slope: &mut Slope) -> f64;
}
