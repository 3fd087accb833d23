//! Start states once more, each segment for itself.
//!
//! Dry friction and stops make a segment's squares uneven in its start state: the number of half swings
//! before it sticks is a whole number. A step that serves all segments together leaves a single one behind in
//! a hollow of its own, and that one then holds the coefficients. So each segment may begin again: where it
//! is, where its first samples point, or at rest at its mean value.

use crate::ending::SHORT;
use crate::fit::extended;
use crate::hypothesis::Hypothesis;
use crate::matrices::raised;
use crate::response::{Prediction, Simulator};
use crate::segments::Segment;
use crate::statistics::{mean, median};

/// Mean square relative to the median segment's, beyond which a segment begins again.
const BEHIND: f64 = 1.25;

/// Steps tried for one start at most.
const STEPS: usize = 8;

/// Relative decrease of the squares at which to stop, promised or made.
const SMALL: f64 = 1e-4;

/// Gives the segments that fit worse than others better start states, where there are any. Predictions follow along.
pub(crate) fn settle(
    simulator: &mut Simulator<'_>,
    hypothesis: &Hypothesis,
    segments: &[Segment],
    starts: &mut [Vec<f64>],
    predictions: &mut [Prediction],
) -> bool {
    let usual = median(&predictions.iter().map(Prediction::mean_square).collect::<Vec<_>>());
    let mut better = false;
    for ((segment, start), prediction) in segments.iter().zip(starts).zip(predictions) {
        if prediction.mean_square() <= BEHIND * usual {
            continue;
        }
        let rest = extended(&[mean(&segment.values), 0.0], hypothesis);
        let guess = extended(&segment.guess, hypothesis);
        let others = [guess, rest].map(|from| simulator.predict(segment, &from).ok().map(|at| (from, at)));
        let here = Some((start.clone(), prediction.clone()));
        for (from, at) in [here].into_iter().chain(others).flatten() {
            let (found, fitted) = descend(simulator, segment, from, at);
            if fitted.residual.norm_squared() < 0.999 * prediction.residual.norm_squared() {
                (*start, *prediction) = (found, fitted);
                better = true;
            }
        }
    }
    better
}

/// Levenberg–Marquardt in one segment's start state alone, from where its prediction is `at`.
fn descend(
    simulator: &mut Simulator<'_>,
    segment: &Segment,
    from: Vec<f64>,
    mut at: Prediction,
) -> (Vec<f64>, Prediction) {
    let count = from.len();
    let mut start = from;
    let mut damping = 1e-4;
    for _ in 0..STEPS {
        let own = at.jacobian.columns(0, count);
        let right = own.tr_mul(&at.residual);
        let Some(solved) = raised(&own.tr_mul(&own), damping).cholesky() else { break };
        let step = solved.solve(&right);
        let before = at.residual.norm_squared();
        if damping <= SHORT && right.dot(&step) <= SMALL * before {
            break;
        }
        let next: Vec<f64> = start.iter().zip(step.iter()).map(|(value, step)| value + step).collect();
        match simulator.predict(segment, &next) {
            Ok(trial) if trial.residual.norm_squared() < before => {
                let gain = before - trial.residual.norm_squared();
                (start, at) = (next, trial);
                damping *= 0.1;
                if gain <= SMALL * before {
                    break;
                }
            }
            _ => damping *= 10.0,
        }
    }
    (start, at)
}
