//! Records as the fits use them: observations, segments and the scales derived from them.

pub(crate) mod checks;
pub(crate) mod joined;
pub(crate) mod observations;
pub(crate) mod period;
pub(crate) mod pieces;
pub(crate) mod release;
pub(crate) mod scales;
pub(crate) mod segments;
pub(crate) mod split;
