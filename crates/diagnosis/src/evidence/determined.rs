//! Which numbers the data determine.
//!
//! A number is not determined where its 95 % interval is wider, to either side, than the scale of the motion over which
//! it would make a difference, and does not tell it from none: a rest angle that may lie anywhere within the swing, a
//! damping that may be critical or nothing. Scales follow from the motion alone: its amplitude, its frequency, the
//! inertia.

use crate::answer::Interval;
use crate::data::scales::Scales;
use dynamics::Quantity;
use std::f64::consts::PI;

/// The size of a quantity at which it does as much as all that moves the body does.
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

/// How many times the scale of the motion an interval reaches to either side.
pub(crate) fn reach(facts: &Scales, quantity: Quantity, estimate: &Interval) -> f64 {
    let [low, high] = estimate.interval_95;
    let reach = 0.5 * (high - low) / scale(facts, quantity);
    if reach.is_nan() { f64::INFINITY } else { reach }
}

/// Whether the data determine a number.
pub(crate) fn says_something(facts: &Scales, quantity: Quantity, estimate: &Interval) -> bool {
    let [low, high] = estimate.interval_95;
    // No position and no angle is none.
    let has_a_zero = !matches!(quantity, Quantity::Position | Quantity::Angle);
    let is_told_from_none = has_a_zero && (low > 0.0 || high < 0.0);
    is_told_from_none || reach(facts, quantity, estimate) <= 1.0
}
