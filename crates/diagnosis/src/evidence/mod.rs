//! Evidence from the fits: for sets, classes and effects, and for a left-over.

pub(crate) mod context;
pub(crate) mod determined;
pub(crate) mod discrepancy;
pub(crate) mod half_swings;
pub(crate) mod held_out;
pub(crate) mod inclusion;
pub(crate) mod left_over;
pub(crate) mod probability;
pub(crate) mod shapley;
pub(crate) mod weighed_sets;
