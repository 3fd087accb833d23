//! Fits of weights and start states to free runs, by Levenberg–Marquardt with exact sensitivities.
//!
//! The start states are eliminated piece by piece (Schur complement).
#![allow(clippy::indexing_slicing, reason = "rows and columns follow from the shape")]

use super::network::Shape;
use crate::linear::{raised, solve};
use least_squares::{Descent, Method};
use nalgebra::{DMatrix, DVector};

/// Stretch to be predicted, in scaled units: observed values, and the inputs of every sample.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub(super) values: Vec<f64>,
    pub(super) inputs: Vec<f64>,
}

/// Normal prior of numbers: means and precisions.
#[derive(Debug, Clone)]
pub(super) struct Prior {
    pub(super) mean: Vec<f64>,
    pub(super) precision: Vec<f64>,
}

impl Prior {
    fn loss(&self, at: &[f64]) -> f64 {
        let away = at.iter().zip(&self.mean).zip(&self.precision);
        away.map(|((own, mean), precision)| precision * (own - mean).powi(2)).sum()
    }

    /// Adds the prior to normal equations.
    fn add(&self, at: &[f64], matrix: &mut DMatrix<f64>, right: &mut DVector<f64>) {
        for (place, own) in at.iter().enumerate() {
            matrix[(place, place)] += self.precision[place];
            right[place] -= self.precision[place] * (own - self.mean[place]);
        }
    }
}

/// Least-squares problem. The loss is that of squared errors, in squares of the scale, plus those of the priors.
pub(super) struct Problem<'a> {
    pub(super) shape: &'a Shape,
    pub(super) pieces: &'a [Piece],
    /// Prior of the weights; `None` keeps them as they are.
    pub(super) weights: Option<Prior>,
    /// Prior of every start state.
    pub(super) start: Prior,
}

/// Normal equations of one piece: weights, weights × start, start.
struct Block {
    own: DMatrix<f64>,
    mixed: DMatrix<f64>,
    start: DMatrix<f64>,
    right: DVector<f64>,
    start_right: DVector<f64>,
}

/// Weights, start states and the loss there.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Point {
    pub(super) weights: Vec<f64>,
    pub(super) starts: Vec<Vec<f64>>,
    pub(super) loss: f64,
}

/// Method of the fits: three steps in a row that gain little end one.
const METHOD: Method = Method { first: 1e-2, least: 1e-9, max_damping: 1e8, ..Method::TENFOLD };
const SMALL: f64 = 1e-4;
const SMALL_STEPS: u32 = 3;

impl Problem<'_> {
    /// Minimizes from a first guess. `observe` gets the number of the step and the loss, and returns `false` to stop.
    pub(super) fn fit(
        &self,
        weights: Vec<f64>,
        starts: Vec<Vec<f64>>,
        max_steps: u64,
        mut observe: impl FnMut(u64, f64) -> bool,
    ) -> Point {
        let mut point = self.at(weights, starts);
        let mut descent = Descent::new(Method { max_steps, ..METHOD });
        let (mut small, mut blocks) = (0, self.blocks(&point));
        while small < SMALL_STEPS
            && let Ok(damping) = descent.next_damping()
        {
            let next = self.step(&point, &blocks, damping);
            if descent.advance(&mut point, next, |point| point.loss) {
                small = if descent.last_gain < SMALL { small + 1 } else { 0 };
                blocks = self.blocks(&point);
            }
            if !observe(descent.steps, point.loss) {
                break;
            }
        }
        point
    }

    /// Returns the loss at a point; infinite where a run diverges.
    fn at(&self, weights: Vec<f64>, starts: Vec<Vec<f64>>) -> Point {
        let mut loss = self.weights.as_ref().map_or(0.0, |prior| prior.loss(&weights));
        for (piece, start) in self.pieces.iter().zip(&starts) {
            let run = self.shape.run(&weights, start, &piece.inputs, piece.values.len(), false);
            let observed = run.states.iter().step_by(self.shape.states);
            let squares = observed.zip(&piece.values).map(|(own, value)| (own - value).powi(2)).sum::<f64>();
            loss += squares + self.start.loss(start);
        }
        Point { weights, starts, loss: if loss.is_nan() { f64::INFINITY } else { loss } }
    }

    fn blocks(&self, point: &Point) -> Vec<Block> {
        let (states, weights) = (self.shape.states, point.weights.len());
        let block = |(piece, start): (&Piece, &Vec<f64>)| {
            let run = self.shape.run(&point.weights, start, &piece.inputs, piece.values.len(), true);
            // Samples after a divergence tell nothing.
            let kept = run.states.chunks_exact(states).take_while(|state| !state[0].is_nan()).count();
            let jacobian =
                DMatrix::from_row_slice(kept, weights + states, &run.slopes[..kept * (weights + states)]);
            let errors = piece.values.iter().zip(run.states.chunks_exact(states)).take(kept);
            let errors = DVector::from_iterator(kept, errors.map(|(value, state)| value - state[0]));
            let (normal, right) = (jacobian.tr_mul(&jacobian), jacobian.tr_mul(&errors));
            let mut start_block = normal.view((weights, weights), (states, states)).into_owned();
            let mut start_right = right.rows(weights, states).into_owned();
            self.start.add(start, &mut start_block, &mut start_right);
            Block {
                own: normal.view((0, 0), (weights, weights)).into_owned(),
                mixed: normal.view((0, weights), (weights, states)).into_owned(),
                start: start_block,
                right: right.rows(0, weights).into_owned(),
                start_right,
            }
        };
        self.pieces.iter().zip(&point.starts).map(block).collect()
    }

    /// Returns the point after a damped step; `None` if there is none.
    fn step(&self, point: &Point, blocks: &[Block], damping: f64) -> Option<Point> {
        let count = point.weights.len();
        let (mut matrix, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
        let inverses: Vec<DMatrix<f64>> =
            blocks.iter().map(|block| raised(&block.start, damping).try_inverse()).collect::<Option<_>>()?;
        let mut change = DVector::zeros(count);
        if let Some(prior) = &self.weights {
            for (block, inverse) in blocks.iter().zip(&inverses) {
                let gain = &block.mixed * inverse;
                matrix += &block.own - &gain * block.mixed.transpose();
                right += &block.right - gain * &block.start_right;
            }
            prior.add(&point.weights, &mut matrix, &mut right);
            change = solve(&raised(&matrix, damping), &right)?;
        }
        let weights = point.weights.iter().zip(change.iter()).map(|(own, by)| own + by).collect();
        let starts =
            point.starts.iter().zip(blocks.iter().zip(&inverses)).map(|(start, (block, inverse))| {
                let by = inverse * (&block.start_right - block.mixed.tr_mul(&change));
                start.iter().zip(by.iter()).map(|(own, by)| own + by).collect()
            });
        Some(self.at(weights, starts.collect()))
    }
}
