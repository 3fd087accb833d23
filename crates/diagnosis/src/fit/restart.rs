//! Restarts of single segments from other start states.
//!
//! With dry friction and stops, a segment's sum of squares is uneven in its start state, because the number
//! of half swings before it sticks is a whole number. A step for all segments together can leave a single one
//! behind in a local minimum, and that one then holds back the coefficients. So each segment may begin again
//! from several start states: its present one, the guess from its first samples, rest at its mean value, or a
//! fit to longer and longer beginnings of it.

use crate::data::segments::{Data, Segment};
use crate::fit::fitted::{Point, extended};
use crate::fit::normal_equations::raised_start;
use crate::fit::stopping::SHORT;
use crate::model::hypothesis::Hypothesis;
use crate::model::predictor::{Derivatives, Prediction, Simulator};
use crate::noise::statistics::{mean, median};
use dynamics::DynamicsError;
use least_squares::{Descent, Method};

/// Mean square, relative to the median over the segments, beyond which a segment begins again.
const BEHIND: f64 = 1.25;

/// Share of all squares that it has to leave beyond the median as well: no other start state gains more than
/// that. In simulated records with friction 3 % of the gain of all new beginnings was below, at a third of their
/// cost.
const WORTH: f64 = 0.02;

/// Ratio of squares to those at the present start state beyond which another beginning is not worth a
/// descent. Of 3,700 beginnings tried in simulated records with friction, 113 ended lower, and all but one of
/// these began less than 1.6 times as high. In measured records the farthest one began 8 times as high and
/// gained little.
const FAR_OFF: f64 = 5.0;

/// Method of a descent from one start state.
const METHOD: Method = Method { first: 1e-4, max_steps: 8, tolerance: SMALL, ..Method::TENFOLD };

/// Relative decrease of the squares at which a descent stops, promised or made.
const SMALL: f64 = 1e-4;

/// Finds better start states for the segments that fit worse than others. Returns them with their segments'
/// indices; empty if there are none.
///
/// # Errors
/// Returns an error if the motion cannot be computed at the point.
pub(crate) fn settle(
    data: &Data,
    hypothesis: &Hypothesis,
    point: &Point,
    predictions: &[Prediction],
) -> Result<Vec<(usize, Vec<f64>)>, DynamicsError> {
    let usual = median(&predictions.iter().map(Prediction::mean_square).collect::<Vec<_>>());
    let all: f64 = predictions.iter().map(|prediction| prediction.residual.norm_squared()).sum();
    let mut simulator = Simulator::new(data, hypothesis, &point.globals, Derivatives::Starts)?;
    let sizes = hypothesis.start_sizes(&data.facts);
    let mut better = Vec::new();
    for (index, ((segment, start), prediction)) in
        data.segments.iter().zip(&point.starts).zip(predictions).enumerate()
    {
        let count = segment.times.len() as f64;
        let is_behind = |squares: f64| squares > (BEHIND * usual * count).max(usual * count + WORTH * all);
        if !is_behind(prediction.residual.norm_squared()) {
            continue;
        }
        let rest = extended(&[mean(&segment.values), 0.0], hypothesis);
        let guess = extended(&segment.guess, hypothesis);
        let far_off = FAR_OFF * prediction.residual.norm_squared();
        let mut begun = vec![(start.clone(), prediction.clone())];
        for from in [guess.clone(), rest] {
            let Ok(at) = simulator.predict(segment, &from) else { continue };
            if at.residual.norm_squared() < far_off {
                begun.push((from, at));
            }
        }
        let mut least = prediction.residual.norm_squared();
        let (mut best, mut left) = (None, least);
        let mut try_from = |from, at, simulator: &mut Simulator<'_>| {
            let (found, fitted) = descend(simulator, segment, &sizes, from, at);
            let squares = fitted.residual.norm_squared();
            if squares < 0.999 * least {
                (least, best) = (squares, Some(found));
            }
            least
        };
        for (from, at) in begun {
            left = try_from(from, at, &mut simulator);
        }
        // The costly beginning is for segments that no other one brings near the rest.
        if is_behind(left)
            && let Some(from) = lengthened(&mut simulator, segment, &sizes, &guess, left)
            && let Ok(at) = simulator.predict(segment, &from)
        {
            try_from(from, at, &mut simulator);
        }
        better.extend(best.map(|start| (index, start)));
    }
    Ok(better)
}

/// Shares of a segment that a start state is fitted to, one after the other.
const SHARES: [f64; 4] = [0.06, 0.14, 0.3, 0.6];

/// Fewest samples that a start state is fitted to.
const FEWEST: usize = 8;

/// Returns a start state that was fitted to longer and longer beginnings of a segment, from its guess: each one
/// is nearly in phase with the next, where a fit of the whole from afar may lose count of the swings. `None` if a
/// beginning alone leaves more squares than `known`, those of the whole from another start state.
fn lengthened(
    simulator: &mut Simulator<'_>,
    segment: &Segment,
    sizes: &[Option<f64>],
    guess: &[f64],
    known: f64,
) -> Option<Vec<f64>> {
    let mut start = guess.to_vec();
    for share in SHARES {
        let count = (share * segment.times.len() as f64) as usize;
        if count < FEWEST {
            continue;
        }
        let beginning = Segment {
            times: segment.times.get(..count)?.to_vec(),
            values: segment.values.get(..count)?.to_vec(),
            parts: segment.parts.iter().copied().filter(|from| *from < count).collect(),
            ..segment.clone()
        };
        let at = simulator.predict(&beginning, &start).ok()?;
        let (found, fitted) = descend(simulator, &beginning, sizes, start, at);
        if fitted.residual.norm_squared() > known {
            return None;
        }
        start = found;
    }
    Some(start)
}

/// Minimizes the squares of one segment over its start state alone (Levenberg–Marquardt). `at` is the
/// prediction for the first start state.
fn descend(
    simulator: &mut Simulator<'_>,
    segment: &Segment,
    sizes: &[Option<f64>],
    from: Vec<f64>,
    at: Prediction,
) -> (Vec<f64>, Prediction) {
    let mut best = (from, at);
    let mut descent = Descent::new(METHOD);
    while let Ok(damping) = descent.next_damping() {
        let (start, at) = &best;
        let own = at.jacobian.columns(0, start.len());
        let right = own.tr_mul(&at.residual);
        let matrix = raised_start(&own.tr_mul(&own), damping, at.residual.norm_squared(), sizes);
        let Some(solved) = matrix.cholesky() else { break };
        let step = solved.solve(&right);
        if damping <= SHORT && right.dot(&step) <= SMALL * at.residual.norm_squared() {
            break;
        }
        let next: Vec<f64> = start.iter().zip(step.iter()).map(|(value, step)| value + step).collect();
        let next = simulator.predict(segment, &next).ok().map(|trial| (next, trial));
        descent.advance(&mut best, next, |(_, at)| at.residual.norm_squared());
    }
    best
}
