//! The swing that a second body is told from.

/// The swing that a second body is told from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MainMode {
    /// Angular frequency in rad/s.
    pub(crate) frequency: f64,
    /// Decay rate of its amplitude in 1/s.
    pub(crate) decay_rate: f64,
    pub(crate) inertia: f64,
    /// Whether each record has one start state, at its beginning.
    pub(crate) starts_once: bool,
}
