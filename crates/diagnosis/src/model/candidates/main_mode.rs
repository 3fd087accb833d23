//! Main motion, from which a second body or a forcing has to differ.

use crate::data::scales::Repeats;

/// Main motion, from which a second body or a forcing has to differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MainMode {
    /// Angular frequency in rad/s.
    pub(crate) frequency: f64,
    /// Decay rate of the amplitude in 1/s.
    pub(crate) decay_rate: f64,
    pub(crate) inertia: f64,
    /// Difference of angular frequencies that the longest record is too short to resolve: over the record,
    /// lines that close differ by less than a turn.
    pub(crate) resolution: f64,
    /// `true` if each record has one start state, at its beginning.
    pub(crate) starts_once: bool,
    /// Repetition of a driven motion; `None` if it does not repeat.
    pub(crate) repeats: Option<Repeats>,
}
