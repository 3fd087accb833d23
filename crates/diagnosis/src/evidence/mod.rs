//! Evidence from the fits: for sets, classes and effects, and for a left-over.

pub(crate) mod conclusion;
pub(crate) mod context;
pub(crate) mod determined;
pub(crate) mod discrepancy;
#[allow(dead_code, reason = "what durations and centers say is read by tests and tables only")]
pub(crate) mod half_swings;
pub(crate) mod held_out;
pub(crate) mod inclusion;
pub(crate) mod left_over;
pub(crate) mod likelihood;
pub(crate) mod probability;
pub(crate) mod score;
pub(crate) mod weighed_sets;
pub(crate) mod weights;
