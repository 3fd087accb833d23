//! What is exported.

use dynamics::chain::Observed;
use dynamics::{Active, Coordinate, Quantity, Start, System, Units};

/// A nominal simulator with the effects it lacked, and what observes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Repaired {
    /// The oscillator with the effects in the system.
    pub system: System,
    /// Units of its numbers: those of the simulator as it was given.
    pub units: Units,
    /// The effects in the measuring chain.
    pub chain: Vec<Active>,
    /// What cannot be part of it, each in a sentence.
    pub left_out: Vec<String>,
    /// Whether an input drives it.
    pub driven: bool,
    /// Where the motion of the first record starts.
    pub start: Start,
    /// What the sensor observes.
    pub observed: Observed,
    /// Standard deviation of the sensor's noise.
    pub noise: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// Length of the first record in seconds.
    pub seconds: f64,
}

impl Repaired {
    /// The unit of a quantity; of what the sensor observes, by what that is.
    #[must_use]
    pub fn unit(&self, quantity: Quantity) -> &'static str {
        let derivatives = match self.observed {
            Observed::Position => 0,
            Observed::Velocity => 1,
            Observed::Acceleration => 2,
        };
        let order = match quantity {
            Quantity::Observed => derivatives,
            Quantity::ObservedPerTime => derivatives + 1,
            _ => return quantity.unit(self.units),
        };
        let (Units::Si(coordinate) | Units::PerInertia(coordinate)) = self.units;
        match (coordinate, order) {
            (Coordinate::Angle, 0) => "rad",
            (Coordinate::Angle, 1) => "rad/s",
            (Coordinate::Angle, 2) => "rad/s^2",
            (Coordinate::Angle, _) => "rad/s^3",
            (Coordinate::Displacement, 0) => "m",
            (Coordinate::Displacement, 1) => "m/s",
            (Coordinate::Displacement, 2) => "m/s^2",
            (Coordinate::Displacement, _) => "m/s^3",
        }
    }
}
