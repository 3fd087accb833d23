//! Modes of a record, in the form of results.

use identify::Estimated;
use record::{Clock, Record};
use results::{ModeRow, WithInterval};

/// Distance of the ends of a 95 % interval from the estimate, in standard errors.
const NINETY_FIVE: f64 = 1.96;

/// Returns the modes of a free decay under a clock, the most powerful first; empty if it shows only one.
#[must_use]
pub fn modes(record: &Record, clock: &Clock) -> Vec<ModeRow> {
    mode_rows(&identify::modes(record, clock))
}

/// Returns modes as rows of a result; none for a single mode.
#[must_use]
pub fn mode_rows(modes: &[identify::Mode]) -> Vec<ModeRow> {
    let number = |found: Estimated| {
        let half = NINETY_FIVE * found.std_error;
        WithInterval { value: found.value, interval_95: [found.value - half, found.value + half] }
    };
    let row = |mode: &identify::Mode| ModeRow {
        frequency_hz: number(mode.frequency_hz),
        damping_ratio: number(mode.damping_ratio),
        share: mode.share,
    };
    if modes.len() > 1 { modes.iter().map(row).collect() } else { Vec::new() }
}
