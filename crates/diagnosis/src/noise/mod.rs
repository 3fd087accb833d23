//! Noise of a record: its size, its spectrum, and the statistics of both.

pub(crate) mod high_pass;
pub(crate) mod periodogram;
pub(crate) mod ratio;
pub(crate) mod rounding;
pub(crate) mod statistics;
