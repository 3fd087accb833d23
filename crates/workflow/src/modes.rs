//! Modes of a record, in the form of results.

use identify::Estimated;
use record::{Clock, Record};
use results::{ModeRow, Resonance, WithInterval};

/// Returns the modes of a free decay under a clock, the most powerful first; empty if it shows only one.
#[must_use]
pub fn modes(record: &Record, clock: &Clock) -> Vec<ModeRow> {
    mode_rows(&identify::modes(record, clock))
}

/// Returns the sharpness of an oscillator's resonance, if it has one.
#[must_use]
pub fn resonance(frequency_hz: Estimated, damping_ratio: Estimated) -> Option<Resonance> {
    Resonance::of(number(frequency_hz), number(damping_ratio))
}

fn number(found: Estimated) -> WithInterval {
    WithInterval::normal(found.value, found.std_error)
}

/// Returns modes and steady lines as rows of a result; none for a single mode.
#[must_use]
pub fn mode_rows(modes: &[identify::Mode]) -> Vec<ModeRow> {
    let row = |mode: &identify::Mode| {
        let (frequency_hz, damping_ratio) = (number(mode.frequency_hz), number(mode.damping_ratio));
        let resonance = Resonance::of(frequency_hz, damping_ratio).filter(|_| !mode.is_steady);
        ModeRow { frequency_hz, damping_ratio, resonance, share: mode.share, steady: mode.is_steady }
    };
    if modes.len() > 1 { modes.iter().map(row).collect() } else { Vec::new() }
}
