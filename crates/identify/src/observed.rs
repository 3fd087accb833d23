//! What a record says of its input and of what its sensor observes.

use record::{Clock, Quantity, Record};

/// Times and values of the input where it drives anything, with those of rows that hold no value of the sensor's; an input
/// that never changes tells no gain.
pub(crate) fn input(record: &Record, clock: &Clock) -> Option<Vec<(f64, f64)>> {
    let own = record.input().filter(|input| input.windows(2).any(|pair| pair.first() != pair.last()))?;
    let sampled = clock.times_s.iter().copied().zip(own.iter().copied());
    let mut input: Vec<(f64, f64)> = sampled.chain(clock.inputs_between(record)).collect();
    input.sort_by(|one, other| one.0.total_cmp(&other.0));
    Some(input)
}

/// How often the observed quantity was differentiated.
pub(crate) fn order(quantity: Quantity) -> usize {
    match quantity {
        Quantity::Position => 0,
        Quantity::Velocity => 1,
        Quantity::Acceleration => 2,
    }
}
