//! Detection of the time at which a record begins to swing freely.
//!
//! A log is usually started before the release: a hand holds the body, or draws it back, until it lets go. A
//! free swing passes its middle twice in a period. So whatever comes more than half a period before the first
//! passage was not a free swing.

use crate::answer::Finding;
use crate::data::observations::Observations;
use crate::data::period::swing;

/// Part of a period before the first passage that is too long for a free swing. Half a period is the limit;
/// the rest is room for a period that is longer at large amplitude.
const TOO_LONG: f64 = 0.75;

/// Minimum number of cycles that the swing has to go on for afterwards.
const FEWEST_CYCLES: f64 = 3.0;

/// Returns the time in seconds up to which a record does not swing freely; `None` if it swings freely from
/// its start, or is driven. The last quarter period before the first passage is free too, but its start is
/// not known.
pub(crate) fn held_until(record: &Observations) -> Option<f64> {
    let found = swing(&record.times_s, &record.values).filter(|_| record.input.is_none())?;
    let is_held = found.first_s > TOO_LONG * found.period_s && found.cycles >= FEWEST_CYCLES;
    is_held.then_some(found.first_s)
}

/// Returns the finding that reports the part left out.
pub(crate) fn finding(until_s: f64) -> Finding {
    Finding {
        effect: None,
        text: format!(
            "the first {until_s:.2} s are left out, because they are not a free swing: something held the \
             body until the release"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::held_until;
    use crate::data::observations::Observations;
    use record::{Clock, ClockChoice, Quantity, Record};

    /// 20 s at 100 samples a second: `before` up to the time `until`, and from then on a swing with a period
    /// of 1 s, released at rest.
    fn record(until: f64, before: impl Fn(f64) -> f64) -> Observations {
        let times: Vec<f64> = (0..2000).map(|i| f64::from(i) / 100.0).collect();
        let swing = |t: f64| 0.5 * (-0.1 * t).exp() * (std::f64::consts::TAU * t).cos();
        let values = times.iter().map(|&t| if t < until { before(t) } else { swing(t - until) }).collect();
        let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
        Observations::new(&record, &Clock::new(&record, ClockChoice::Auto).unwrap())
    }

    #[test]
    fn what_goes_before_the_release_is_seen() {
        for until in [0.0, 0.1, 0.3] {
            assert_eq!(held_until(&record(until, |_| 0.5)), None, "{until}");
        }
        for until in [0.6, 3.0] {
            let quarter = until + 0.25;
            let drawn_back = |t: f64| 0.4 + 0.1 * t / until;
            for found in [held_until(&record(until, |_| 0.5)), held_until(&record(until, drawn_back))] {
                assert!((found.unwrap() - quarter).abs() < 0.03, "{until} {found:?}");
            }
        }
    }

    #[test]
    fn what_is_struck_at_rest_swings_from_its_first_turn_on() {
        let found = held_until(&record(2.0, |_| 0.0)).unwrap();
        assert!((found - 2.25).abs() < 0.02, "{found}");
    }
}
