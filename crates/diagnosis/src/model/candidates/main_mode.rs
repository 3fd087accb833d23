//! The motion that a second body or a forcing is told from.

/// The motion that a second body or a forcing is told from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MainMode {
    /// Angular frequency in rad/s.
    pub(crate) frequency: f64,
    /// Decay rate of its amplitude in 1/s.
    pub(crate) decay_rate: f64,
    pub(crate) inertia: f64,
    /// Largest deflection.
    pub(crate) amplitude: f64,
    /// Whether each record has one start state, at its beginning.
    pub(crate) starts_once: bool,
    /// How a driven motion repeats.
    pub(crate) repeats: Option<Repeats>,
}

/// A motion that is driven over the same way again and again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Repeats {
    /// Angular frequency of its repetition.
    pub(crate) frequency: f64,
    /// Angular frequencies that the record is too short to tell apart.
    pub(crate) resolution: f64,
}

impl Repeats {
    /// Whether an angular frequency is a multiple of the repetition's.
    pub(crate) fn has(&self, frequency: f64) -> bool {
        let order = (frequency / self.frequency).round().max(1.0);
        (frequency - order * self.frequency).abs() < 0.5 * self.resolution
    }
}
