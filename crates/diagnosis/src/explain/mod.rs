//! What the answer shows beside its names: gap, shares, maps, the repaired simulator and the next experiment.

pub(crate) mod attribution;
pub(crate) mod backbone;
pub(crate) mod coefficients;
pub(crate) mod gap;
pub(crate) mod maps;
pub(crate) mod next_experiment;
pub(crate) mod position_torque;
pub(crate) mod repaired;
pub(crate) mod single_effect;
