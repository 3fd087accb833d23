//! Test of whether the data determine a number.
//!
//! A number is not determined if its 95 % interval extends, to either side, beyond the scale of the motion
//! over which the number makes a difference, and if the interval includes zero: a rest angle anywhere within
//! the swing, a damping between none and critical. The scales follow from the motion alone: its amplitude,
//! its frequency, the inertia.

use crate::data::scales::Scales;
use dynamics::Quantity;
use results::WithInterval;
use std::f64::consts::PI;

/// Returns the size at which a quantity has as much effect as all other causes of the motion.
fn scale(facts: &Scales, quantity: Quantity) -> f64 {
    let (amplitude, speed) = (facts.amplitude, facts.speed);
    match quantity {
        Quantity::Inertia => facts.inertia,
        Quantity::Torque => facts.torque,
        Quantity::Position => amplitude,
        Quantity::Velocity => speed,
        Quantity::Stiffness => facts.torque / amplitude,
        Quantity::QuadraticStiffness => facts.torque / amplitude.powi(2),
        Quantity::CubicStiffness => facts.torque / amplitude.powi(3),
        Quantity::Damping => facts.torque / speed,
        Quantity::QuadraticDamping => facts.torque / speed.powi(2),
        Quantity::CubicDamping => facts.torque / speed.powi(3),
        Quantity::DeflectionDamping => facts.torque / speed / amplitude.powi(2),
        Quantity::QuinticStiffness => facts.torque / amplitude.powi(5),
        Quantity::InverseVelocity => 1.0 / speed,
        Quantity::Wavenumber => 1.0 / amplitude,
        Quantity::Time => 1.0 / facts.frequency,
        Quantity::Rate => 1.0 / facts.duration,
        Quantity::AngularFrequency => facts.frequency,
        Quantity::Angle => PI,
        Quantity::Observed => facts.reading,
        Quantity::ObservedPerTime => facts.reading / facts.duration,
        Quantity::Ratio => 1.0,
        Quantity::Samples => f64::INFINITY,
    }
}

/// Returns the half width of an interval in units of the scale of the motion; infinite if it is not a number.
pub(crate) fn reach(facts: &Scales, quantity: Quantity, estimate: &WithInterval) -> f64 {
    let [low, high] = estimate.interval_95;
    let reach = 0.5 * (high - low) / scale(facts, quantity);
    if reach.is_nan() { f64::INFINITY } else { reach }
}

/// Returns `true` if the data determine a number.
pub(crate) fn says_something(facts: &Scales, quantity: Quantity, estimate: &WithInterval) -> bool {
    let [low, high] = estimate.interval_95;
    // For a position or an angle, zero does not mean absence.
    let has_a_zero = !matches!(quantity, Quantity::Position | Quantity::Angle);
    let is_told_from_none = has_a_zero && (low > 0.0 || high < 0.0);
    is_told_from_none || reach(facts, quantity, estimate) <= 1.0
}
