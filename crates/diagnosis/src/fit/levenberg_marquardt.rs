//! Levenberg–Marquardt over all segments at once, start states eliminated.
//!
//! The normal equations are an arrow: each segment's start state meets only its own samples, the global parameters
//! meet all. Start states are eliminated segment by segment (Schur complement), so the cost is linear in the
//! number of samples. Bounds hold by projection: a parameter that a step would push out of its range stays at
//! the end of it, and the step is solved anew for the others.
//!
//! # Reference
//! Marquardt, Journal of the Society for Industrial and Applied Mathematics 11 (1963) 431 (scaling by the
//! diagonal); Nielsen, Technical University of Denmark IMM-REP-1999-05 (how the damping follows the gain);
//! Bock, in Modelling of Chemical Reaction Systems, Springer 1981, 102 (multiple shooting).

use crate::data::segments::{Data, Segment};
use crate::fit::restart::settle;
pub(crate) use crate::fit::stopping::Stopping;
use crate::fit::stopping::{Ending, SHORT};
use crate::model::candidate::Parameter;
use crate::model::hypothesis::Hypothesis;
use crate::model::matrices::{element, entry, raised, set};
use crate::model::predictor::{Derivatives, Prediction, Simulator};
use crate::noise::statistics::{autocorrelation_time, median};
use dynamics::DynamicsError;
use nalgebra::{DMatrix, DVector};

/// Where a fit is: global parameters, and a start state for each segment.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Point {
    pub(crate) globals: Vec<f64>,
    pub(crate) starts: Vec<Vec<f64>>,
}

impl Point {
    /// Degrees of freedom that so many samples keep.
    pub(crate) fn freedom(&self, samples: usize) -> f64 {
        let starts: usize = self.starts.iter().map(Vec::len).sum();
        (samples as f64 - starts as f64 - self.globals.len() as f64).max(1.0)
    }
}

/// A fitted hypothesis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fit {
    pub(crate) hypothesis: Hypothesis,
    pub(crate) point: Point,
    /// Residuals by segment, observed minus predicted.
    pub(crate) residuals: Vec<DVector<f64>>,
    pub(crate) squares: f64,
    /// Whether the steps became small before the budget was spent.
    pub(crate) converged: bool,
    /// Global parameters that ended at an end of their range.
    pub(crate) at_bound: Vec<bool>,
    /// (JᵀJ)⁻¹ of the global parameters, start states eliminated; times the noise variance it is a covariance. Without
    /// rows where only start states were moved.
    pub(crate) inverse: DMatrix<f64>,
}

/// What is moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Moving {
    /// Start states only.
    Starts,
    /// Start states and every global parameter.
    All,
}

/// Start states from the segments' guesses.
pub(crate) fn first_starts(data: &Data, hypothesis: &Hypothesis) -> Vec<Vec<f64>> {
    data.segments.iter().map(|segment| extended(&segment.guess, hypothesis)).collect()
}

/// A start state with as many entries as a hypothesis has: that of known hidden bodies stays where there is one, others
/// move along.
pub(crate) fn extended(start: &[f64], hypothesis: &Hypothesis) -> Vec<f64> {
    let known = start.iter().copied().take(hypothesis.least_start_length());
    let along = start.iter().copied().take(2).cycle();
    let missing = hypothesis.start_length().saturating_sub(known.len());
    known.chain(along.take(missing)).collect()
}

impl Fit {
    pub(crate) fn samples(&self) -> usize {
        self.residuals.iter().map(DVector::len).sum()
    }

    /// Number of parameters that are fitted to all segments.
    pub(crate) fn globals(&self) -> usize {
        self.point.globals.len()
    }

    /// Degrees of freedom of the residual.
    pub(crate) fn freedom(&self) -> f64 {
        self.point.freedom(self.samples())
    }

    pub(crate) fn autocorrelation_time(&self) -> f64 {
        let pieces: Vec<&[f64]> = self.residuals.iter().map(DVector::as_slice).collect();
        autocorrelation_time(&pieces)
    }
}

/// Blocks of the normal equations of one segment.
struct Block {
    own: DMatrix<f64>,
    shared: DMatrix<f64>,
    right: DVector<f64>,
}

struct Equations {
    blocks: Vec<Block>,
    globals: DMatrix<f64>,
    right: DVector<f64>,
}

fn evaluate(
    simulator: &mut Simulator<'_>,
    segments: &[Segment],
    point: &Point,
) -> Result<Vec<Prediction>, DynamicsError> {
    simulator.set(&point.globals)?;
    segments.iter().zip(&point.starts).map(|(segment, start)| simulator.predict(segment, start)).collect()
}

/// The same for a trial that is of use only below a bound on the weighted squares; `None` as soon as these
/// are above it, which spares the rest of the segments.
fn evaluate_below(
    simulator: &mut Simulator<'_>,
    segments: &[Segment],
    point: &Point,
    weights: &[f64],
    bound: f64,
) -> Option<Vec<Prediction>> {
    simulator.set(&point.globals).ok()?;
    let mut predictions = Vec::with_capacity(segments.len());
    let mut total = 0.0;
    for ((segment, start), weight) in segments.iter().zip(&point.starts).zip(weights) {
        let prediction = simulator.predict(segment, start).ok()?;
        total += weight * prediction.residual.norm_squared();
        // A residual that is not a number is no gain either.
        if total.is_nan() || total > bound {
            return None;
        }
        predictions.push(prediction);
    }
    Some(predictions)
}

/// Squares of a hypothesis at a point.
///
/// # Errors
/// What the dynamics refuse at that point.
pub(crate) fn squares(data: &Data, hypothesis: &Hypothesis, point: &Point) -> Result<f64, DynamicsError> {
    let mut simulator = Simulator::new(data, hypothesis, &point.globals, Derivatives::None)?;
    let at = evaluate(&mut simulator, &data.segments, point)?;
    Ok(at.iter().map(|prediction| prediction.residual.norm_squared()).sum())
}

/// Residuals of a fit on the same segments with other inputs.
///
/// # Errors
/// What the dynamics refuse there.
pub(crate) fn residuals(data: &Data, at: &Fit) -> Result<Vec<DVector<f64>>, DynamicsError> {
    let mut simulator = Simulator::new(data, &at.hypothesis, &at.point.globals, Derivatives::None)?;
    let predictions = evaluate(&mut simulator, &data.segments, &at.point)?;
    Ok(predictions.into_iter().map(|prediction| prediction.residual).collect())
}

/// Lets segments that are behind begin again, at the coefficients of `point`.
fn begin_again(
    simulator: &mut Simulator<'_>,
    data: &Data,
    hypothesis: &Hypothesis,
    point: &mut Point,
    at: &mut [Prediction],
) -> Result<bool, DynamicsError> {
    // A trial that came to nothing has left its coefficients behind.
    simulator.set(&point.globals)?;
    let better = settle(data, hypothesis, point, at)?;
    let mut begun = false;
    for (index, start) in better {
        let Some(segment) = data.segments.get(index) else { continue };
        let prediction = simulator.predict(segment, &start)?;
        if let (Some(slot), Some(known)) = (at.get_mut(index), point.starts.get_mut(index)) {
            (*slot, *known) = (prediction, start);
            begun = true;
        }
    }
    Ok(begun)
}

/// The damping that a fit begins with, and begins with again.
const FIRST_DAMPING: f64 = 1e-4;

/// The damping falls by this at most after a step that gained what was promised; it stays where a step gained
/// less than half.
const LOWEST_CUT: f64 = 1.0 / 3.0;

/// The damping rises by this after a step that gained nothing, and by its square and cube after the next ones. Too
/// little more of it gives the same step once more: with Nielsen's 2 and a damping of 1e-4, four steps out of five
/// that followed a failed one failed as well.
const RAISE: f64 = 8.0;

/// Mean square relative to the median segment's, beyond which a segment is heeded less.
const DOUBTFUL: f64 = 2.0;

/// Weights of the segments: 1 up to [`DOUBTFUL`], falling with the mean square beyond.
fn trust(predictions: &[Prediction]) -> Vec<f64> {
    let own: Vec<f64> = predictions.iter().map(Prediction::mean_square).collect();
    let usual = median(&own).max(f64::MIN_POSITIVE);
    own.into_iter().map(|square| (DOUBTFUL * usual / square.max(f64::MIN_POSITIVE)).min(1.0)).collect()
}

fn weighted(predictions: &[Prediction], weights: &[f64]) -> f64 {
    predictions.iter().zip(weights).map(|(p, weight)| weight * p.residual.norm_squared()).sum()
}

/// Normal equations of the weighted segments.
fn equations(predictions: &[Prediction], weights: &[f64], starts: usize, globals: usize) -> Equations {
    let mut total = DMatrix::zeros(globals, globals);
    let mut right = DVector::zeros(globals);
    let mut blocks = Vec::with_capacity(predictions.len());
    for (prediction, &weight) in predictions.iter().zip(weights) {
        let own = prediction.jacobian.columns(0, starts);
        let shared = prediction.jacobian.columns(starts, globals);
        total += weight * shared.tr_mul(&shared);
        right += weight * shared.tr_mul(&prediction.residual);
        blocks.push(Block {
            own: weight * own.tr_mul(&own),
            shared: weight * own.tr_mul(&shared),
            right: weight * own.tr_mul(&prediction.residual),
        });
    }
    Equations { blocks, globals: total, right }
}

/// Solves a symmetric system, scaled to a unit diagonal first: parameters differ by many orders of magnitude.
pub(crate) fn solve(matrix: &DMatrix<f64>, right: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let scale: Vec<f64> =
        matrix.diagonal().iter().map(|d| if *d > 0.0 { 1.0 / d.sqrt() } else { 1.0 }).collect();
    let at = |i: usize| scale.get(i).copied().unwrap_or(1.0);
    let scaled = DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| {
        entry(matrix, i, j) * at(i) * at(j) + if i == j { 1e-13 } else { 0.0 }
    });
    let scaled_right = DMatrix::from_fn(right.nrows(), right.ncols(), |i, j| entry(right, i, j) * at(i));
    let solution = scaled.cholesky()?.solve(&scaled_right);
    Some(DMatrix::from_fn(right.nrows(), right.ncols(), |i, j| entry(&solution, i, j) * at(i)))
}

/// What stands in an inverse for a parameter that changes nothing: its error is without bounds, and no number is spoiled
/// by an infinite one.
pub(crate) const UNBOUNDED: f64 = 1e150;

/// The inverse of the normal equations of the parameters that can move; `plain` is their matrix before start states were
/// eliminated.
fn inverse(matrix: &DMatrix<f64>, plain: &DMatrix<f64>, parameters: &[Parameter]) -> Option<DMatrix<f64>> {
    let count = matrix.nrows();
    let is_open = |index: &usize| parameters.get(*index).is_none_or(|own| own.lower < own.upper);
    let acts = |index: &usize| entry(plain, *index, *index) > 0.0;
    let free: Vec<usize> = (0..count).filter(|index| is_open(index) && acts(index)).collect();
    let part = matrix.select_rows(&free).select_columns(&free);
    let inverse = solve(&part, &DMatrix::identity(free.len(), free.len()))?;
    let mut all = DMatrix::zeros(count, count);
    for (row, &i) in free.iter().enumerate() {
        for (column, &j) in free.iter().enumerate() {
            set(&mut all, i, j, entry(&inverse, row, column));
        }
    }
    for index in (0..count).filter(|index| is_open(index) && !acts(index)) {
        set(&mut all, index, index, UNBOUNDED);
    }
    Some(all)
}

impl Equations {
    /// The reduced system of the global parameters that are free.
    fn reduced(&self, damping: f64) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let mut matrix = raised(&self.globals, damping);
        let mut right = self.right.clone();
        for block in &self.blocks {
            let eliminated = raised(&block.own, damping).cholesky()?;
            let solved = eliminated.solve(&block.shared);
            matrix -= block.shared.tr_mul(&solved);
            right -= solved.tr_mul(&block.right);
        }
        Some((matrix, right))
    }

    /// The step of everything, with some global parameters held.
    fn step(&self, damping: f64, held: &[bool]) -> Option<(DVector<f64>, Vec<DVector<f64>>)> {
        let (matrix, right) = self.reduced(damping)?;
        let free: Vec<usize> =
            held.iter().enumerate().filter(|(_, held)| !**held).map(|(index, _)| index).collect();
        let part = matrix.select_rows(&free).select_columns(&free);
        let part_right = DMatrix::from_iterator(free.len(), 1, free.iter().map(|&i| element(&right, i)));
        let mut step = DVector::zeros(right.len());
        if !free.is_empty() {
            let solution = solve(&part, &part_right)?;
            for (value, &index) in solution.iter().zip(&free) {
                if let Some(slot) = step.get_mut(index) {
                    *slot = *value;
                }
            }
        }
        let mut starts = Vec::with_capacity(self.blocks.len());
        for block in &self.blocks {
            let right = &block.right - &block.shared * &step;
            starts.push(raised(&block.own, damping).cholesky()?.solve(&right));
        }
        Some((step, starts))
    }

    /// Where a step leads from a point, every parameter within its range, and by how much it would decrease the squares
    /// if the motion were linear in everything; no point where the system cannot be solved.
    fn trial(
        &self,
        from: &Point,
        damping: f64,
        parameters: &[Parameter],
        mut held: Vec<bool>,
    ) -> (Option<Point>, f64) {
        let mut promised = f64::INFINITY;
        // Each round holds at least one parameter more.
        for _ in 0..=parameters.len() {
            let Some((step, own)) = self.step(damping, &held) else { break };
            promised = self.promised(&step, &own);
            let mut next = from.clone();
            let mut fresh = false;
            let moves = next.globals.iter_mut().zip(step.iter()).zip(parameters).zip(&mut held);
            for (((value, step), parameter), held) in moves {
                let wanted = *value + step;
                let outside = wanted < parameter.lower || wanted > parameter.upper;
                if outside && !*held {
                    let end = if wanted < parameter.lower { parameter.lower } else { parameter.upper };
                    // At the end already: hold it and solve again. Otherwise go there.
                    if *value == end {
                        (*held, fresh) = (true, true);
                    }
                    *value = end;
                } else {
                    *value = wanted;
                }
            }
            for (start, step) in next.starts.iter_mut().zip(own) {
                for (value, step) in start.iter_mut().zip(step.iter()) {
                    *value += step;
                }
            }
            if !fresh {
                return (Some(next), promised);
            }
        }
        (None, promised)
    }

    /// By how much a step would decrease the squares if the motion were linear in everything.
    fn promised(&self, step: &DVector<f64>, starts: &[DVector<f64>]) -> f64 {
        let own: f64 = self.blocks.iter().zip(starts).map(|(block, own)| block.right.dot(own)).sum();
        self.right.dot(step) + own
    }
}

/// Fits a hypothesis from a point.
///
/// # Errors
/// What the dynamics refuse at that point.
pub(crate) fn fit(
    data: &Data,
    hypothesis: &Hypothesis,
    from: Point,
    moving: Moving,
    effort: Stopping,
) -> Result<Fit, DynamicsError> {
    let parameters = hypothesis.parameters(&data.facts);
    let starts = hypothesis.start_length();
    let (derivatives, globals) = match moving {
        Moving::Starts => (Derivatives::Starts, 0),
        Moving::All => (Derivatives::All, parameters.len()),
    };
    let mut point = from;
    for (value, parameter) in point.globals.iter_mut().zip(&parameters) {
        *value = value.clamp(parameter.lower, parameter.upper);
    }
    let mut simulator = Simulator::new(data, hypothesis, &point.globals, derivatives)?;
    let mut at = evaluate(&mut simulator, &data.segments, &point)?;
    let mut damping = FIRST_DAMPING;
    let mut raise = RAISE;
    let mut converged = false;
    let uneven = !hypothesis.smooth();
    let mut wary = uneven && effort.wary;
    let mut ending = Ending::new(if wary { effort.roughly() } else { effort });
    let mut weights = if wary { trust(&at) } else { vec![1.0; data.segments.len()] };
    let mut system = equations(&at, &weights, starts, globals);
    let mut settled = false;
    // Where beginning again came to nothing on the way, it is tried once more at the end only.
    let mut in_vain = false;
    for step in 1..=effort.steps {
        let sizes = step <= effort.sizes_first;
        let held = parameters.iter().map(|p| moving == Moving::Starts || sizes && p.shape).collect();
        let before = weighted(&at, &weights);
        let (trial, promised) = system.trial(&point, damping, &parameters, held);
        // Nothing more to be had: no need to try.
        let done = ending.promises_nothing(promised / before, damping);
        let outcome = trial.filter(|_| !done || sizes).and_then(|next| {
            let evaluation = evaluate_below(&mut simulator, &data.segments, &next, &weights, before)?;
            Some((next, evaluation))
        });
        match outcome {
            Some((next, evaluation)) => {
                let decrease = before - weighted(&evaluation, &weights);
                ending.gained(decrease / before, damping, &evaluation);
                point = next;
                at = evaluation;
                if wary {
                    weights = trust(&at);
                }
                let quality = decrease / promised;
                damping = (damping * (1.0 - (2.0 * quality - 1.0).powi(3)).clamp(LOWEST_CUT, 1.0)).max(1e-12);
                raise = RAISE;
                if !ending.is_small() {
                    settled = false;
                }
                system = equations(&at, &weights, starts, globals);
            }
            _ if done => ending.nothing_left(),
            _ => {
                damping = (damping * raise).max(1e-6);
                raise *= RAISE;
                if !sizes {
                    ending.failed(promised / before, damping);
                }
            }
        }
        let ended = !sizes && ending.is_reached(damping);
        if wary && (ended || step >= effort.steps / 2) {
            wary = false;
            weights = vec![1.0; data.segments.len()];
            begin_again(&mut simulator, data, hypothesis, &mut point, &mut at)?;
            system = equations(&at, &weights, starts, globals);
            ending = Ending::new(effort);
            (damping, settled) = (FIRST_DAMPING, true);
            continue;
        }
        if uneven && effort.begins_again && !settled && (ended || damping > SHORT && !in_vain) {
            settled = true;
            if begin_again(&mut simulator, data, hypothesis, &mut point, &mut at)? {
                system = equations(&at, &weights, starts, globals);
                ending.begin_again();
                damping = FIRST_DAMPING;
                continue;
            }
            in_vain = true;
        }
        if ended {
            converged = true;
            break;
        }
        if !sizes && !wary && ending.is_in_vain(weighted(&at, &weights), step) {
            break;
        }
    }
    let system = equations(&at, &vec![1.0; data.segments.len()], starts, globals);
    let inverse = system
        .reduced(0.0)
        .and_then(|(matrix, _)| inverse(&matrix, &system.globals, &parameters))
        .unwrap_or_else(|| DMatrix::from_element(globals, globals, f64::INFINITY));
    let at_bound = point
        .globals
        .iter()
        .zip(&parameters)
        .map(|(value, p)| *value <= p.lower || *value >= p.upper)
        .collect();
    Ok(Fit {
        hypothesis: hypothesis.clone(),
        squares: at.iter().map(|prediction| prediction.residual.norm_squared()).sum(),
        residuals: at.into_iter().map(|prediction| prediction.residual).collect(),
        point,
        converged,
        at_bound,
        inverse,
    })
}

#[cfg(test)]
#[path = "levenberg_marquardt_tests.rs"]
mod tests;
