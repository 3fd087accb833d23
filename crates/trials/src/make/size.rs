//! Search for the size of an effect with a wanted detectability.

use super::error::TrialError;
use dynamics::DynamicsError;

/// Relative difference from the wanted detectability that is accepted.
pub(crate) const CLOSE: f64 = 0.01;

/// Largest number of trial sizes. The detectability is nearly a power of the size, and four trials are
/// usually enough.
const ROUNDS: usize = 24;

/// Size and its detectability.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sized {
    pub(crate) size: f64,
    pub(crate) detectability: f64,
}

/// Finds the size at which `detectability` is as wanted, by the secant rule on the logarithms of both; once
/// there is a bracket, bisection keeps the search within it. `None` if no size up to `most` is large enough,
/// no size comes close, or the motion diverges at one.
pub(crate) fn solve(
    wanted: f64,
    guess: f64,
    most: f64,
    mut detectability: impl FnMut(f64) -> Result<f64, TrialError>,
) -> Result<Option<Sized>, TrialError> {
    let top = most.ln();
    let mut at = guess.ln().min(top);
    let (mut below, mut above): (Option<f64>, Option<f64>) = (None, None);
    let mut before: Option<(f64, f64)> = None;
    for _ in 0..ROUNDS {
        let found = match detectability(at.exp()) {
            Err(TrialError::Dynamics(DynamicsError::Diverged { .. })) => return Ok(None),
            found => found?,
        };
        if (found / wanted - 1.0).abs() <= CLOSE {
            return Ok(Some(Sized { size: at.exp(), detectability: found }));
        }
        if !found.is_finite() {
            return Ok(None);
        }
        let miss = (found.max(1e-12) / wanted).ln();
        if miss < 0.0 {
            below = Some(below.map_or(at, |edge| edge.max(at)));
        } else {
            above = Some(above.map_or(at, |edge| edge.min(at)));
        }
        if miss < 0.0 && at >= top {
            return Ok(None);
        }
        let slope = before.map_or(1.0, |(place, other)| (miss - other) / (at - place));
        before = Some((at, miss));
        let slope = if slope.is_finite() { slope.clamp(0.4, 4.0) } else { 1.0 };
        // Far from the answer, a power law gives only a direction.
        let mut next = (at - (miss / slope).clamp(-7.0, 7.0)).min(top);
        if let (Some(low), Some(high)) = (below, above) {
            let inside =
                low.min(high) + 0.02 * (high - low).abs()..=low.max(high) - 0.02 * (high - low).abs();
            if !inside.contains(&next) {
                next = 0.5 * (low + high);
            }
        }
        at = next;
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::{CLOSE, DynamicsError, solve};

    #[test]
    fn powers_steps_and_plateaus_are_solved() {
        let laws: [(&dyn Fn(f64) -> f64, f64); 4] = [
            (&|size: f64| 300.0 * size, 12.0),
            (&|size: f64| 4e5 * size.powf(2.5), 50.0),
            (&|size: f64| 100.0 * size / (size + 0.3), 60.0),
            (&|size: f64| (size - 0.2).max(0.0) * 40.0, 3.0),
        ];
        for (law, wanted) in laws {
            let found = solve(wanted, 1e-3, 10.0, |size| Ok(law(size))).unwrap().unwrap();
            assert!((law(found.size) / wanted - 1.0).abs() <= CLOSE, "{found:?}");
        }
    }

    #[test]
    fn what_is_out_of_reach_is_said_to_be() {
        assert_eq!(solve(60.0, 1e-3, 10.0, |size| Ok(50.0 * size / (size + 1.0))).unwrap(), None);
        let diverges = |_: f64| Err(DynamicsError::Diverged { time_s: 1.0, position: 1e6 }.into());
        assert_eq!(solve(60.0, 1e-3, 10.0, diverges).unwrap(), None);
    }
}
