//! The motion that a second body or a forcing is told from.

use crate::data::scales::Repeats;

/// The motion that a second body or a forcing is told from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MainMode {
    /// Angular frequency in rad/s.
    pub(crate) frequency: f64,
    /// Decay rate of its amplitude in 1/s.
    pub(crate) decay_rate: f64,
    pub(crate) inertia: f64,
    /// Angular frequencies that the longest record is too short to tell apart: lines that close come to less than a turn between them.
    pub(crate) resolution: f64,
    /// Whether each record has one start state, at its beginning.
    pub(crate) starts_once: bool,
    /// How a driven motion repeats.
    pub(crate) repeats: Option<Repeats>,
}
