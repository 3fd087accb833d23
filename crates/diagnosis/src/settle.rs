//! Start states once more, each segment for itself.
//!
//! Dry friction and stops make a segment's squares uneven in its start state: the number of half swings before it sticks
//! is a whole number. A step that serves all segments together leaves a single one behind in a hollow of its own, and
//! that one then holds the coefficients. So each segment may begin again: where it is, where its first samples point,
//! or at rest at its mean value.

use crate::fit::extended;
use crate::hypothesis::Hypothesis;
use crate::matrices::raised;
use crate::response::{Prediction, Simulator};
use crate::segments::Segment;
use crate::statistics::{mean, median};
use dynamics::DynamicsError;

/// Mean square relative to the median segment's, beyond which a segment begins again.
const BEHIND: f64 = 1.25;

/// Steps tried for one start at most.
const STEPS: usize = 8;

/// Gives the segments that fit worse than others better start states, where there are any. Predictions follow along.
pub(crate) fn settle(
    simulator: &mut Simulator<'_>,
    hypothesis: &Hypothesis,
    segments: &[Segment],
    starts: &mut [Vec<f64>],
    predictions: &mut [Prediction],
) -> Result<bool, DynamicsError> {
    let usual = median(&predictions.iter().map(Prediction::mean_square).collect::<Vec<_>>());
    let mut better = false;
    for ((segment, start), prediction) in segments.iter().zip(starts).zip(predictions) {
        if prediction.mean_square() <= BEHIND * usual {
            continue;
        }
        let rest = extended(&[mean(&segment.values), 0.0], hypothesis);
        let guess = extended(&segment.guess, hypothesis);
        for from in [start.clone(), guess, rest] {
            let Some((found, fitted)) = descend(simulator, segment, from) else { continue };
            if fitted.residual.norm_squared() < 0.999 * prediction.residual.norm_squared() {
                (*start, *prediction) = (found, fitted);
                better = true;
            }
        }
    }
    Ok(better)
}

/// Levenberg–Marquardt in one segment's start state alone.
fn descend(
    simulator: &mut Simulator<'_>,
    segment: &Segment,
    from: Vec<f64>,
) -> Option<(Vec<f64>, Prediction)> {
    let count = from.len();
    let mut start = from;
    let mut at = simulator.predict(segment, &start).ok()?;
    let mut damping = 1e-4;
    for _ in 0..STEPS {
        let own = at.jacobian.columns(0, count);
        let step = raised(&own.tr_mul(&own), damping).cholesky()?.solve(&own.tr_mul(&at.residual));
        let next: Vec<f64> = start.iter().zip(step.iter()).map(|(value, step)| value + step).collect();
        let trial = simulator.predict(segment, &next).ok();
        let (before, after) = (at.residual.norm_squared(), trial.as_ref().map(|t| t.residual.norm_squared()));
        match (trial, after) {
            (Some(trial), Some(after)) if after < before => {
                (start, at) = (next, trial);
                damping *= 0.1;
                if before - after <= 1e-4 * before {
                    break;
                }
            }
            _ => damping *= 10.0,
        }
    }
    Some((start, at))
}
