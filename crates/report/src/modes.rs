//! Modes of a record, in words.

use results::{ModeRow, Resonance, WithInterval};

use crate::classes::listed;
use crate::format::{interval, percent, quantity, significant, with_uncertainty};

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

/// A mode or a steady line in a row of the page's table.
pub(crate) struct ModeView {
    pub(crate) name: String,
    pub(crate) frequency: String,
    pub(crate) damping_ratio: String,
    pub(crate) quality: String,
    pub(crate) width: String,
    pub(crate) share: String,
}

/// Returns the rows of the table of modes.
pub(crate) fn mode_views(modes: &[ModeRow]) -> Vec<ModeView> {
    let told = |number: &WithInterval| {
        format!("{} {}", with_uncertainty(number.value, number.std_error()), interval(number.interval_95))
    };
    let none = || "–".to_owned();
    let view = |(at, mode): (usize, &ModeRow)| ModeView {
        name: if mode.steady { "steady line".to_owned() } else { format!("mode {}", at + 1) },
        frequency: told(&mode.frequency_hz),
        damping_ratio: told(&mode.damping_ratio),
        quality: mode.resonance.as_ref().map_or_else(none, quality_factor),
        width: mode.resonance.as_ref().map_or_else(none, half_power_width),
        share: percent(100.0 * mode.share),
    };
    modes.iter().enumerate().map(view).collect()
}

/// Returns sentences on the modes of a record, and on steady lines beside them; empty without modes.
#[must_use]
pub fn sentence(modes: &[ModeRow]) -> String {
    let (lines, modes): (Vec<&ModeRow>, Vec<&ModeRow>) = modes.iter().partition(|mode| mode.steady);
    let uncertain = |number: &WithInterval| with_uncertainty(number.value, number.std_error());
    let frequency = |mode: &ModeRow| quantity(&uncertain(&mode.frequency_hz), "Hz");
    let share = |mode: &ModeRow| format!("{} of the power", percent(100.0 * mode.share));
    let words = |mode: &&ModeRow| {
        let quality = mode.resonance.map(|resonance| format!(", Q = {}", quality_factor(&resonance)));
        format!(
            "{} with a damping ratio of {}{} ({})",
            frequency(mode),
            uncertain(&mode.damping_ratio),
            quality.unwrap_or_default(),
            share(mode)
        )
    };
    let held = (modes.len() > 1).then(|| {
        let words: Vec<String> = modes.iter().map(words).collect();
        format!("The record holds {} modes: {}.", modes.len(), listed(&words, "and"))
    });
    let steady = lines.iter().map(|line| {
        format!(
            "A line at {} ({}) keeps its amplitude while the swing decays, as the hum of the mains or a motor does: no mode.",
            frequency(line),
            share(line)
        )
    });
    held.into_iter().chain(steady).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::{mode_views, sentence};
    use results::{ModeRow, WithInterval};

    #[test]
    fn a_steady_line_is_not_counted_as_a_mode() {
        let row = |hertz: f64, ratio: f64, steady: bool| ModeRow {
            frequency_hz: WithInterval::normal(hertz, 1e-3),
            damping_ratio: WithInterval::normal(ratio, 1e-4),
            resonance: None,
            share: 0.5,
            steady,
        };
        let one = [row(17.0, 0.01, false), row(50.0, 0.0, true)];
        assert!(sentence(&one).starts_with("A line at 50.0000"), "{}", sentence(&one));
        assert_eq!(
            mode_views(&one).iter().map(|view| view.name.as_str()).collect::<Vec<_>>(),
            ["mode 1", "steady line"]
        );
        let two = [row(17.0, 0.01, false), row(31.0, 0.02, false), row(50.0, 0.0, true)];
        assert!(sentence(&two).starts_with("The record holds 2 modes: 17.0000"), "{}", sentence(&two));
    }
}
