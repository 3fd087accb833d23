//! Parts of the answer beside the names of effects: gap, shares, maps, repaired simulator and next
//! experiment.

pub(crate) mod attribution;
pub(crate) mod backbone;
pub(crate) mod coefficients;
pub(crate) mod conclusion;
pub(crate) mod gap;
pub(crate) mod maps;
pub(crate) mod next_experiment;
pub(crate) mod position_torque;
pub(crate) mod repaired;
pub(crate) mod single_effect;
