//! Input and order of differentiation of a record.

use record::{Clock, Quantity, Record};

/// Returns times and values of the input, including rows without a value of the sensor. `None` if there is no
/// input or it never changes: a constant input does not determine a gain.
pub(crate) fn input(record: &Record, clock: &Clock) -> Option<Vec<(f64, f64)>> {
    let own = record.input().filter(|input| input.windows(2).any(|pair| pair.first() != pair.last()))?;
    let sampled = clock.times_s.iter().copied().zip(own.iter().copied());
    let mut input: Vec<(f64, f64)> = sampled.chain(clock.inputs_between(record)).collect();
    input.sort_by(|one, other| one.0.total_cmp(&other.0));
    Some(input)
}

/// Returns the number of times that the observed quantity is differentiated.
pub(crate) fn order(quantity: Quantity) -> usize {
    match quantity {
        Quantity::Position => 0,
        Quantity::Velocity => 1,
        Quantity::Acceleration => 2,
    }
}
