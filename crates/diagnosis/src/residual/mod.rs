//! Residuals on segments: their noise floor and their spectrum.

pub(crate) mod floor;
pub(crate) mod spectrum;
