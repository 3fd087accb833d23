//! The part of a free decay in which amplitude and phase change evenly, as no hand makes them.

use crate::observed::input;
use crate::samples_pipeline::{SamplesPipeline, Window};
use record::{Clock, Record, median};
use std::f64::consts::TAU;

/// Half width of the neighborhood that a step is compared with, in steps.
const BESIDE: usize = 3;
/// Smallest deviation of a step of phase, in radians, or of the logarithm of the amplitude that is uneven, and smallest
/// one in its standard errors.
const UNEVEN: (f64, f64) = (0.1, 8.0);
/// Uneven steps in a row that begin another part.
const FOREIGN: usize = 2;
/// Fewest steps of the even part.
const FEWEST: usize = 5;
/// Part of all steps from which the even part is the whole.
const WHOLE: f64 = 0.93;

/// Returns the times in seconds, by the clock, between which a record swings evenly, if it does not do so as a whole: a
/// hand that moves, leaves or stops a swing slowly shows in windows of a period. `None` for an even record, one
/// with an input, or one that is uneven everywhere.
#[must_use]
pub fn regular_part(record: &Record, clock: &Clock) -> Option<[f64; 2]> {
    if input(record, clock).is_some() {
        return None;
    }
    let (windows, noise) = SamplesPipeline::DEFAULT.clear_windows(record, clock)?;
    let steps: Vec<Step> = windows.windows(2).filter_map(|pair| Step::new(pair, noise)).collect();
    let uneven: Vec<bool> = (0..steps.len()).map(|at| is_uneven(&steps, at)).collect();
    let mut parts = vec![(0, 0)];
    for (at, is_uneven) in uneven.iter().enumerate() {
        let last = parts.last_mut()?;
        let ends = uneven.get(at..).is_some_and(|rest| rest.iter().take(FOREIGN).all(|uneven| *uneven));
        if *is_uneven && (ends || last.0 == last.1) {
            parts.push((at + 1, at + 1));
        } else {
            last.1 = at + 1;
        }
    }
    let (from, to) = parts.into_iter().max_by_key(|(from, to)| to - from)?;
    let is_whole = (to - from) as f64 > WHOLE * steps.len() as f64;
    let even = steps.get(from..to).filter(|even| even.len() >= FEWEST && !is_whole)?;
    Some([even.first()?.from, even.last()?.to])
}

/// Change from one window to the next.
struct Step {
    from: f64,
    to: f64,
    phase: f64,
    logarithm: f64,
    std_error: f64,
}

impl Step {
    fn new(pair: &[Window], noise: f64) -> Option<Self> {
        let [one, next] = pair else { return None };
        let angle = |window: &Window| libm::atan2(window.parts.1, window.parts.0);
        let phase = angle(next) - angle(one);
        let error = |window: &Window| noise * window.leverage.sqrt() / window.amplitude();
        Some(Self {
            from: one.time,
            to: next.time,
            phase: phase - TAU * (phase / TAU).round(),
            logarithm: libm::log(next.amplitude() / one.amplitude()),
            std_error: libm::hypot(error(one), error(next)),
        })
    }
}

/// Returns `true` if a step differs from the median of its neighborhood.
fn is_uneven(steps: &[Step], at: usize) -> bool {
    let beside = steps.get(at.saturating_sub(BESIDE)..(at + BESIDE + 1).min(steps.len()));
    let (Some(step), Some(beside)) = (steps.get(at), beside) else { return false };
    let (least, errors) = UNEVEN;
    let allowed = least.max(errors * step.std_error);
    let far = |of: fn(&Step) -> f64| {
        median(beside.iter().map(of).collect()).is_some_and(|usual| (of(step) - usual).abs() > allowed)
    };
    far(|step| step.phase) || far(|step| step.logarithm)
}

#[cfg(test)]
mod tests {
    use super::regular_part;
    use rand_distr::{Distribution, Normal};
    use record::{Clock, ClockChoice, Quantity, Record};
    use seed::Seed;

    fn part(motion: impl Fn(f64) -> f64) -> Option<[f64; 2]> {
        part_of(Quantity::Position, motion)
    }

    fn part_of(quantity: Quantity, motion: impl Fn(f64) -> f64) -> Option<[f64; 2]> {
        let times: Vec<f64> = (0..4000).map(|at| 0.01 * f64::from(at)).collect();
        let (mut draws, normal) = (Seed::new(5).child("noise").generator(), Normal::new(0.0, 1e-3).unwrap());
        let values = times.iter().map(|time| motion(*time) + normal.sample(&mut draws)).collect();
        let record = Record::new(times, values, None, quantity, "rad").unwrap();
        regular_part(&record, &Clock::new(&record, ClockChoice::Auto).unwrap())
    }

    fn decay(time: f64) -> f64 {
        (-0.04 * time).exp() * (6.0 * time).cos()
    }

    /// Regression: the hand's own frequencies hid the swing's period in the first guess, and nothing was seen.
    #[test]
    fn a_hand_with_frequencies_of_its_own_is_seen() {
        let moved = |time: f64| (2.7 * time).sin() + (8.3 * time + 1.0).cos();
        let free = |time: f64| (-0.012 * time).exp() * (4.3 * time).cos();
        let both = |time: f64| 0.12 * if time < 7.0 { moved(time) } else { free(time - 7.0) };
        let found = part_of(Quantity::Velocity, both).unwrap();
        assert!((6.5..10.0).contains(&found[0]) && found[1] > 37.0, "{found:?}");
    }

    #[test]
    fn a_hand_that_leaves_slowly_is_seen() {
        let pushed = |time: f64| (0.4 + 0.5 * (1.7 * time).sin()) * (5.2 * time + (1.1 * time).sin()).cos();
        let found = part(|time| if time < 8.0 { pushed(time) } else { decay(time - 8.0) }).unwrap();
        assert!((7.0..10.0).contains(&found[0]) && found[1] > 38.0, "{found:?}");
    }

    /// A frequency that falls with the amplitude, dry friction, and a decay into the noise are even.
    #[test]
    fn a_free_swing_is_even() {
        assert_eq!(part(decay), None);
        assert_eq!(part(|time| (-0.3 * time).exp() * (6.0 * time).cos()), None);
        assert_eq!(part(|time| (1.0 - 0.024 * time) * (6.0 * time).cos()), None);
        assert_eq!(part(|time| (-0.05 * time).exp() * (6.0 * time + 4.0 * (-0.1 * time).exp()).cos()), None);
    }
}
