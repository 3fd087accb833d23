//! Changes that an effect would make to a fit, to first order.

pub(crate) mod dictionary;
pub(crate) mod projection;
pub(crate) mod second_mode;
pub(crate) mod tangent;
