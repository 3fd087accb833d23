//! Modes of a record, in words.

use results::{ModeRow, WithInterval};

use crate::classes::listed;
use crate::format::{percent, quantity, with_uncertainty};

/// Returns each mode with its frequency, its damping ratio and its share of the power.
pub(crate) fn mode_words(modes: &[ModeRow]) -> Vec<String> {
    let uncertain = |number: &WithInterval| with_uncertainty(number.value, number.std_error());
    let words = |mode: &ModeRow| {
        let (frequency, ratio) = (uncertain(&mode.frequency_hz), uncertain(&mode.damping_ratio));
        let share = percent(100.0 * mode.share);
        format!("{} with a damping ratio of {ratio} ({share} of the power)", quantity(&frequency, "Hz"))
    };
    modes.iter().map(words).collect()
}

/// Returns a sentence on the modes of a record; empty without modes.
#[must_use]
pub fn sentence(modes: &[ModeRow]) -> String {
    if modes.is_empty() {
        return String::new();
    }
    format!("The record holds {} modes: {}.", modes.len(), listed(&mode_words(modes), "and"))
}
