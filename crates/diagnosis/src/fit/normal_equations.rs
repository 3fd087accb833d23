//! Normal equations of all segments, in the shape of an arrow: each segment's start state affects only its
//! own samples, the global parameters affect all. Start states are eliminated segment by segment (Schur
//! complement).

#![allow(clippy::indexing_slicing, reason = "indices are those of the global parameters")]

use crate::fit::fitted::Point;
use crate::matrices::{raised, solve};
use crate::model::candidate::Parameter;
use crate::model::predictor::Prediction;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Cholesky factors of the matrix of a start state.
type Factors = Cholesky<f64, Dyn>;

/// Blocks of one segment in the normal equations.
struct Block {
    own: DMatrix<f64>,
    shared: DMatrix<f64>,
    right: DVector<f64>,
    /// Weighted squares that the segment leaves.
    squares: f64,
}

/// Normal equations of segments, with start states separate from global parameters.
pub(crate) struct NormalEquations {
    blocks: Vec<Block>,
    globals: DMatrix<f64>,
    right: DVector<f64>,
    /// Sizes of the variables of a start state.
    sizes: Vec<Option<f64>>,
}

impl NormalEquations {
    /// Creates the normal equations of weighted segments. `sizes` are those of the variables of a start state.
    pub(crate) fn of(
        predictions: &[Prediction],
        weights: &[f64],
        sizes: Vec<Option<f64>>,
        globals: usize,
    ) -> Self {
        let starts = sizes.len();
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
                squares: weight * prediction.residual.norm_squared(),
            });
        }
        Self { blocks, globals: total, right, sizes }
    }

    /// Returns the factors with which a step of some damping eliminates the start states.
    fn factors(&self, damping: f64) -> Option<Vec<Factors>> {
        let raised = |block: &Block| raised_start(&block.own, damping, block.squares, &self.sizes);
        self.blocks.iter().map(|block| raised(block).cholesky()).collect()
    }

    /// Returns the system of the global parameters after the start states have been eliminated.
    fn reduced(&self, damping: f64, factors: &[Factors]) -> (DMatrix<f64>, DVector<f64>) {
        let mut matrix = raised(&self.globals, damping);
        let mut right = self.right.clone();
        for (block, factors) in self.blocks.iter().zip(factors) {
            let solved = factors.solve(&block.shared);
            matrix -= block.shared.tr_mul(&solved);
            right -= solved.tr_mul(&block.right);
        }
        (matrix, right)
    }

    /// Solves for the step of all parameters, with some global parameters held. `factors` eliminate the start states
    /// from the system of the global ones, `matrix` and `right`.
    fn step(
        &self,
        factors: &[Factors],
        (matrix, right): &(DMatrix<f64>, DVector<f64>),
        held: &[bool],
    ) -> Option<(DVector<f64>, Vec<DVector<f64>>)> {
        let free: Vec<usize> =
            held.iter().enumerate().filter(|(_, held)| !**held).map(|(index, _)| index).collect();
        let part = matrix.select_rows(&free).select_columns(&free);
        let part_right = DMatrix::from_iterator(free.len(), 1, free.iter().map(|&i| right[i]));
        let mut step = DVector::zeros(right.len());
        if !free.is_empty() {
            let solution = solve(&part, &part_right)?;
            for (value, &index) in solution.iter().zip(&free) {
                step[index] = *value;
            }
        }
        let own =
            |(block, factors): (&Block, &Factors)| factors.solve(&(&block.right - &block.shared * &step));
        let starts = self.blocks.iter().zip(factors).map(own).collect();
        Some((step, starts))
    }

    /// Returns the point that a step leads to, with every parameter within its range, and the decrease of the
    /// squares that the linearized motion promises; `None` in place of the point if the system cannot be
    /// solved.
    pub(crate) fn trial(
        &self,
        from: &Point,
        damping: f64,
        parameters: &[Parameter],
        mut held: Vec<bool>,
    ) -> (Option<Point>, f64) {
        let mut promised = f64::INFINITY;
        let Some(factors) = self.factors(damping) else { return (None, promised) };
        let reduced = self.reduced(damping, &factors);
        // Each round holds at least one more parameter.
        for _ in 0..=parameters.len() {
            let Some((step, own)) = self.step(&factors, &reduced, &held) else { break };
            promised = self.promised(&step, &own);
            let mut next = from.clone();
            let mut fresh = false;
            let moves = next.globals.iter_mut().zip(step.iter()).zip(parameters).zip(&mut held);
            for (((value, step), parameter), held) in moves {
                let wanted = *value + step;
                let outside = wanted < parameter.lower || wanted > parameter.upper;
                if outside && !*held {
                    let end = if wanted < parameter.lower { parameter.lower } else { parameter.upper };
                    // A parameter that is at the limit already is held and the system solved again; another
                    // one moves to it.
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

    /// Returns the decrease of the squares by a step if the motion were linear in all parameters.
    fn promised(&self, step: &DVector<f64>, starts: &[DVector<f64>]) -> f64 {
        let own: f64 = self.blocks.iter().zip(starts).map(|(block, own)| block.right.dot(own)).sum();
        self.right.dot(step) + own
    }

    /// Returns (JᵀJ)⁻¹ of the global parameters; infinite if the system cannot be solved.
    pub(crate) fn inverse(&self, parameters: &[Parameter]) -> DMatrix<f64> {
        let count = self.right.len();
        let factors: Option<Vec<_>> =
            self.blocks.iter().map(|block| raised(&block.own, 0.0).cholesky()).collect();
        factors
            .and_then(|factors| inverse(&self.reduced(0.0, &factors).0, &self.globals, parameters))
            .unwrap_or_else(|| DMatrix::from_element(count, count, f64::INFINITY))
    }
}

/// Share of what a segment leaves that a step of a state variable by its own size costs, without damping.
const COST: f64 = 0.1;

/// Raises the normal matrix of a start state for a step; `sizes` are those of its variables, `None` where steps cost nothing.
///
/// A hidden state may hardly show in the samples, as the motion of a second body does while dry friction holds the first
/// one. Its diagonal entry is then nearly zero, however much it is raised, and the step has no bound. So a step also
/// costs a part of the squares that the segment leaves. At the minimum there is no step and no cost.
pub(crate) fn raised_start(
    own: &DMatrix<f64>,
    damping: f64,
    squares: f64,
    sizes: &[Option<f64>],
) -> DMatrix<f64> {
    let mut matrix = raised(own, damping);
    for (at, size) in sizes.iter().enumerate() {
        if let Some(size) = size {
            matrix[(at, at)] += (COST + damping) * squares / (size * size);
        }
    }
    matrix
}

/// Entry of an inverse for a parameter that has no effect: its error has no bound. The entry is finite
/// because an infinite one would spoil the numbers computed from it.
pub(crate) const UNBOUNDED: f64 = 1e150;

/// Inverts the normal equations of the parameters that can move. `plain` is their matrix before start states
/// were eliminated.
fn inverse(matrix: &DMatrix<f64>, plain: &DMatrix<f64>, parameters: &[Parameter]) -> Option<DMatrix<f64>> {
    let count = matrix.nrows();
    let is_open = |index: &usize| parameters.get(*index).is_none_or(|own| own.lower < own.upper);
    let acts = |index: &usize| plain[(*index, *index)] > 0.0;
    let free: Vec<usize> = (0..count).filter(|index| is_open(index) && acts(index)).collect();
    let part = matrix.select_rows(&free).select_columns(&free);
    let inverse = solve(&part, &DMatrix::identity(free.len(), free.len()))?;
    let mut all = DMatrix::zeros(count, count);
    for (row, &i) in free.iter().enumerate() {
        for (column, &j) in free.iter().enumerate() {
            all[(i, j)] = inverse[(row, column)];
        }
    }
    for index in (0..count).filter(|index| is_open(index) && !acts(index)) {
        all[(index, index)] = UNBOUNDED;
    }
    Some(all)
}
