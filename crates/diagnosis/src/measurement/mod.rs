//! Measurement chain: its signatures in stamps and values, outliers, clock rates and encoder hysteresis.

pub(crate) mod chain;
pub(crate) mod clock_rates;
pub(crate) mod encoder_hysteresis;
pub(crate) mod neighbors;
pub(crate) mod outliers;
pub(crate) mod signatures;
pub(crate) mod stale;
