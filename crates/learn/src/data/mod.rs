//! Sets of records, split by record or by time, with the scales that every learner needs.

mod period;
mod set;
mod smoothing;
mod split;
#[cfg(test)]
mod tests;
mod trajectory;
mod windows;

pub use period::{noise_floor, period};
pub use set::{DataSet, LEAST_PAST, Making, Scale};
pub use smoothing::{LocalState, local_states};
pub(crate) use smoothing::{interpolated, local_state};
pub use split::{Parts, Split, SplitKind};
pub use trajectory::Trajectory;
pub(crate) use trajectory::span_s;
pub use windows::{Window, windows};

/// Formats a count with its noun.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    if count == 1 { format!("{count} {noun}") } else { format!("{count} {noun}s") }
}
