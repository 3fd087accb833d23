//! Main motion, from which a second body or a forcing has to differ.

use crate::data::scales::Repeats;
use crate::noise::periodogram::has_line;
use dynamics::Input;

/// Main motion, from which a second body or a forcing has to differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MainMode<'a> {
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
    /// Input of each record.
    pub(crate) inputs: &'a [Option<Input>],
}

impl MainMode<'_> {
    /// Returns `true` if an input has a line at an angular frequency. What moves the body there may have come by
    /// the input's own path: its derivative, a delay, another behavior between its samples.
    pub(crate) fn is_of_input(&self, frequency: f64) -> bool {
        self.inputs.iter().flatten().any(|input| has_line(input.times(), input.values(), frequency))
    }
}
