//! Modes of a record, in words.

use results::{ModeRow, Resonance, WithInterval};

use crate::classes::listed;
use crate::format::{percent, quantity, significant, with_uncertainty};

/// Formats a quality factor with its standard error, or with its lower end alone if ζ may be zero.
#[must_use]
pub fn quality_factor(resonance: &Resonance) -> String {
    let Resonance { quality_factor: quality, half_power_width_hz: width } = resonance;
    let [lowest, highest] = quality.interval_95;
    if highest.is_infinite() {
        return format!("{}, at least {}", significant(quality.value, 2), significant(lowest, 2));
    }
    // The error of the frequency, which is known far better than the damping, is all that the two do not share.
    with_uncertainty(quality.value, quality.value * width.std_error() / width.value)
}

/// Formats a half-power width in Hz with its standard error.
#[must_use]
pub fn half_power_width(resonance: &Resonance) -> String {
    let width = &resonance.half_power_width_hz;
    with_uncertainty(width.value, width.std_error())
}

/// Returns each mode with its frequency, its damping ratio, its quality factor and its share of the power.
pub(crate) fn mode_words(modes: &[ModeRow]) -> Vec<String> {
    let uncertain = |number: &WithInterval| with_uncertainty(number.value, number.std_error());
    let words = |mode: &ModeRow| {
        let (frequency, ratio) = (uncertain(&mode.frequency_hz), uncertain(&mode.damping_ratio));
        let share = percent(100.0 * mode.share);
        let quality = mode.resonance.map(|resonance| format!(", Q = {}", quality_factor(&resonance)));
        format!(
            "{} with a damping ratio of {ratio}{} ({share} of the power)",
            quantity(&frequency, "Hz"),
            quality.unwrap_or_default()
        )
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
