//! What a record says of its input and of what its sensor observes.

use record::{Quantity, Record};

/// The input where it drives anything: one that never changes tells no gain.
pub(crate) fn input(record: &Record) -> Option<&[f64]> {
    record.input().filter(|input| input.windows(2).any(|pair| pair.first() != pair.last()))
}

/// How often the observed quantity was differentiated.
pub(crate) fn order(quantity: Quantity) -> usize {
    match quantity {
        Quantity::Position => 0,
        Quantity::Velocity => 1,
        Quantity::Acceleration => 2,
    }
}
