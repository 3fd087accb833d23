//! Damping, accepted steps and stopping.

use crate::minimum::StopReason;
use serde::{Deserialize, Serialize};

/// Rule for the damping, and limits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Method {
    /// Damping of the first step, in the unit that the solver of the normal equations gives it.
    pub first: f64,
    /// Smallest and largest factor after an accepted step; between them it is 1 − (2ρ − 1)³ with the gain ratio ρ.
    pub cut: (f64, f64),
    /// Smallest damping after an accepted step.
    pub least: f64,
    /// Factor after a rejected step.
    pub raise: f64,
    /// Further factor for each rejected step directly before.
    pub growth: f64,
    /// Smallest damping after a rejected step.
    pub least_raised: f64,
    /// Largest number of steps, including rejected ones.
    pub max_steps: u64,
    /// Relative decrease of the loss by an accepted step at or below which the method has converged.
    pub tolerance: f64,
    /// Number of rejected steps in a row after which the point counts as stationary.
    pub max_rejections: u32,
    /// Damping above which steps are too short to have an effect: the point then counts as stationary.
    pub max_damping: f64,
}

impl Method {
    /// Damping by the gain ratio: Nielsen, report IMM-REP-1999-05 (DTU 1999), equation 2.5. Ended by twelve
    /// rejected steps in a row.
    pub const NIELSEN: Self = Self {
        first: 1e-3,
        cut: (1.0 / 3.0, f64::INFINITY),
        least: 0.0,
        raise: 2.0,
        growth: 2.0,
        least_raised: 0.0,
        max_steps: u64::MAX,
        tolerance: 0.0,
        max_rejections: 12,
        max_damping: f64::INFINITY,
    };
    /// Damping by factors of ten: Marquardt, J. SIAM 11 (1963) 431. Ended by a damping above 10⁸.
    pub const TENFOLD: Self = Self {
        cut: (0.1, 0.1),
        raise: 10.0,
        growth: 1.0,
        max_rejections: u32::MAX,
        max_damping: 1e8,
        ..Self::NIELSEN
    };
}

/// Descent in progress.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Descent {
    /// Rule and limits.
    pub method: Method,
    /// Damping of the next step.
    pub damping: f64,
    /// Number of rejected steps since the last accepted one.
    pub rejections: u32,
    /// Number of steps tried.
    pub steps: u64,
    /// Relative decrease of the loss by the last accepted step; infinite before it.
    pub last_gain: f64,
}

impl Descent {
    /// Creates a descent before its first step.
    #[must_use]
    pub const fn new(method: Method) -> Self {
        Self { method, damping: method.first, rejections: 0, steps: 0, last_gain: f64::INFINITY }
    }

    /// Begins a step and returns its damping.
    ///
    /// # Errors
    /// The reason why the descent has stopped.
    pub fn next_damping(&mut self) -> Result<f64, StopReason> {
        if self.last_gain <= self.method.tolerance {
            return Err(StopReason::Settled);
        }
        if self.is_stationary() {
            return Err(StopReason::Stationary);
        }
        if self.steps >= self.method.max_steps {
            return Err(StopReason::StepsSpent);
        }
        self.steps += 1;
        Ok(self.damping)
    }

    /// Returns `true` if too many steps in a row were rejected.
    #[must_use]
    pub fn is_stationary(&self) -> bool {
        self.rejections >= self.method.max_rejections || self.damping > self.method.max_damping
    }

    /// Returns `true` if no step gains more than the tolerance.
    #[must_use]
    pub fn is_converged(&self) -> bool {
        self.last_gain <= self.method.tolerance || self.is_stationary()
    }

    /// Accepts a step with a gain ratio and a relative decrease of the loss.
    pub fn accept(&mut self, ratio: f64, gain: f64) {
        let (smallest, largest) = self.method.cut;
        let factor = (1.0 - (2.0 * ratio - 1.0).powi(3)).max(smallest).min(largest);
        self.damping = (self.damping * factor).max(self.method.least);
        (self.rejections, self.last_gain) = (0, gain);
    }

    /// Rejects a step.
    pub fn reject(&mut self) {
        let growth = self.method.growth.powi(self.rejections.try_into().unwrap_or(i32::MAX));
        self.damping = (self.damping * (self.method.raise * growth)).max(self.method.least_raised);
        self.rejections = self.rejections.saturating_add(1);
    }

    /// Moves to a trial point and returns `true` if its loss is smaller; rejects the step if it is not, or if
    /// there is no such point.
    pub fn advance<P>(&mut self, at: &mut P, trial: Option<P>, loss: impl Fn(&P) -> f64) -> bool {
        let before = loss(at);
        let lower = trial.map(|trial| (loss(&trial), trial)).filter(|(after, _)| *after < before);
        let is_lower = lower.is_some();
        match lower {
            Some((after, trial)) => {
                *at = trial;
                self.accept(1.0, (before - after) / before);
            }
            None => self.reject(),
        }
        is_lower
    }
}

/// Predicted decrease of the loss, as a share of the loss, below which rounding errors hide the actual one.
const ROUNDING_SHARE: f64 = 1e-10;

/// Returns `true` if rounding errors hide the decrease of the loss that is predicted for a step.
#[must_use]
pub fn is_rounding(loss: f64, predicted: f64) -> bool {
    predicted <= ROUNDING_SHARE * loss
}

/// Returns the gain ratio of a step, its actual over its predicted decrease of the loss, at most 1; `None` if the
/// step has to be rejected because it does not lower the loss.
///
/// A step whose decrease rounding hides has to lower the gradient instead, and its ratio is 1: the loss is
/// flat to rounding over half the digits of the parameters, the gradient is not.
#[must_use]
pub fn gain_ratio([loss, next]: [f64; 2], predicted: f64, is_flatter: impl FnOnce() -> bool) -> Option<f64> {
    if is_rounding(loss, predicted) {
        return (is_flatter() && next <= loss * (1.0 + ROUNDING_SHARE)).then_some(1.0);
    }
    (next < loss).then(|| ((loss - next) / predicted).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::{Descent, Method, gain_ratio};
    use crate::minimum::StopReason;

    #[test]
    fn rejections_in_a_row_raise_the_damping_ever_faster() {
        let mut descent = Descent::new(Method { first: 1.0, ..Method::NIELSEN });
        for raised in [2.0, 8.0, 64.0] {
            descent.reject();
            assert_eq!(descent.damping, raised);
        }
        for (ratio, factor) in [(0.25, 1.125), (0.5, 1.0), (0.75, 0.875), (1.0, 1.0 / 3.0)] {
            let before = descent.damping;
            descent.accept(ratio, 1.0);
            assert_eq!(descent.damping, factor * before);
        }
        let before = descent.damping;
        descent.reject();
        assert_eq!(descent.damping, 2.0 * before);
    }

    #[test]
    fn below_rounding_the_gradient_decides() {
        assert_eq!(gain_ratio([1.0, 0.75], 0.5, || false), Some(0.5));
        assert_eq!(gain_ratio([1.0, 0.25], 0.5, || false), Some(1.0));
        assert_eq!(gain_ratio([1.0, 1.0], 0.5, || true), None);
        assert_eq!(gain_ratio([1.0, f64::NAN], 0.5, || true), None);
        assert_eq!(gain_ratio([1.0, 1.0 + 1e-12], 1e-11, || true), Some(1.0));
        assert_eq!(gain_ratio([1.0, 1.0 + 1e-12], 1e-11, || false), None);
        assert_eq!(gain_ratio([1.0, 1.0 + 1e-9], 1e-11, || true), None);
    }

    #[test]
    fn a_descent_ends_at_each_of_its_limits() {
        let limits = Method { max_steps: 5, tolerance: 1e-3, max_damping: 1e3, ..Method::TENFOLD };
        let method = Method { first: 1.0, least: 0.5, ..limits };
        let none = f64::NAN;
        for (losses, reason, damping) in [
            (vec![0.5, 0.6, 0.7, 0.4999], StopReason::Settled, 5.0),
            (vec![1.0, 2.0, none, none], StopReason::Stationary, 1e4),
            (vec![0.9, 0.8, 0.7, none, none], StopReason::StepsSpent, 50.0),
        ] {
            let (mut descent, mut at) = (Descent::new(method), 1.0);
            for next in &losses {
                assert!(descent.next_damping().is_ok(), "{descent:?}");
                let trial = Some(*next).filter(|next| !next.is_nan());
                assert_eq!(descent.advance(&mut at, trial, |loss| *loss), at == *next && *next < 1.0);
            }
            assert_eq!((descent.next_damping(), descent.damping), (Err(reason), damping));
            assert_eq!(descent.is_converged(), reason != StopReason::StepsSpent);
        }
    }
}
