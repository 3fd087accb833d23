//! Readings of a sensor with hysteresis, which lag behind the motion in either direction.
//!
//! A magnetic encoder keeps its last step to avoid flicker, and a counter may pass a line at different places
//! in the two directions: the reading follows only once the motion is ahead of it by a width. In a swing the
//! reading is shifted against the direction of motion, by a square wave whose size does not decay. The odd
//! harmonics of this wave tell it from friction; its phase shows as a frequency that changes toward the end
//! of a decay.
//!
//! # Reference
//! Brokate and Sprekels, Hysteresis and Phase Transitions, Springer 1996, section 2.1 (the play operator).

/// Reading of the sensor at one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reading {
    pub(crate) value: f64,
    /// Derivative by the width.
    pub(crate) by_width: f64,
    /// Index of the sample that moved the reading there.
    pub(crate) since: usize,
}

/// Returns the reading at the first sample of a swing with some rate and curvature: behind the value by the
/// width, or on its way there if the swing has reversed just before.
fn first(value: f64, width: f64, rate: f64, curvature: f64) -> Reading {
    let direction = if rate == 0.0 { curvature } else { rate }.signum();
    // Distance since the reversal, if the curvature was the present one since then.
    let way = if rate * curvature > 0.0 || rate == 0.0 {
        0.5 * rate * rate / curvature.abs().max(f64::MIN_POSITIVE)
    } else {
        f64::INFINITY
    };
    if way < 2.0 * width {
        Reading { value: value + direction * (width - way), by_width: direction, since: 0 }
    } else {
        Reading { value: value - direction * width, by_width: -direction, since: 0 }
    }
}

/// Returns the readings of values that begin with some rate and curvature. At a reversal of the motion,
/// readings stay constant until the motion has come back by twice the width.
pub(crate) fn readings(
    values: impl Iterator<Item = f64>,
    width: f64,
    rate: f64,
    curvature: f64,
) -> Vec<Reading> {
    let mut all: Vec<Reading> = Vec::new();
    for (since, value) in values.enumerate() {
        let before = all.last().copied().unwrap_or_else(|| first(value, width, rate, curvature));
        all.push(if before.value > value + width {
            Reading { value: value + width, by_width: 1.0, since }
        } else if before.value < value - width {
            Reading { value: value - width, by_width: -1.0, since }
        } else {
            before
        });
    }
    all
}
