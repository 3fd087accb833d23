//! First look at a log: what it was taken for, and the linear oscillator nearest to it.

mod damping;
mod looked;
mod remarks;

pub use looked::Looked;
pub use remarks::of_decay;
