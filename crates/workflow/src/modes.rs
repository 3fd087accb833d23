//! Modes of a record, in the form of results.

use identify::Estimated;
use record::{Clock, Record};
use results::{ModeRow, WithInterval};

/// Returns the modes of a free decay under a clock, the most powerful first; empty if it shows only one.
#[must_use]
pub fn modes(record: &Record, clock: &Clock) -> Vec<ModeRow> {
    mode_rows(&identify::modes(record, clock))
}

/// Returns modes as rows of a result; none for a single mode.
#[must_use]
pub fn mode_rows(modes: &[identify::Mode]) -> Vec<ModeRow> {
    let number = |found: Estimated| WithInterval::normal(found.value, found.std_error);
    let row = |mode: &identify::Mode| ModeRow {
        frequency_hz: number(mode.frequency_hz),
        damping_ratio: number(mode.damping_ratio),
        share: mode.share,
    };
    if modes.len() > 1 { modes.iter().map(row).collect() } else { Vec::new() }
}
