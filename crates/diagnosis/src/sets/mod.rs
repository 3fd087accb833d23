//! Fitted sets of effects: proposals and archive, the shooting interval that sets follow, and what a set weighs.

pub(crate) mod archive;
pub(crate) mod likelihood;
pub(crate) mod proposals;
pub(crate) mod score;
pub(crate) mod shooting_interval;
pub(crate) mod weights;
