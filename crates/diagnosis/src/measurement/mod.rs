//! What stamps and values show of the measurement chain before any physics.

pub(crate) mod chain;
pub(crate) mod clock_rates;
pub(crate) mod encoder_hysteresis;
pub(crate) mod outliers;
pub(crate) mod signatures;
