//! Ranges that systems are drawn from.

/// Ends of what systems, starts and sensors are drawn from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ranges {
    pub(crate) frequency_hz: [f64; 2],
    pub(crate) damping_ratio: [f64; 2],
    pub(crate) release_deg: [f64; 2],
    pub(crate) noise: [f64; 2],
}
