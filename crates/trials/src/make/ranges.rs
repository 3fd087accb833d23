//! Ranges that systems are drawn from.

/// Endpoints of the ranges of systems, starts and sensors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ranges {
    pub(crate) frequency_hz: [f64; 2],
    pub(crate) damping_ratio: [f64; 2],
    pub(crate) release_deg: [f64; 2],
    pub(crate) noise: [f64; 2],
}
