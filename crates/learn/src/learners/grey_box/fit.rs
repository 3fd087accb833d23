//! Fits of a law's parameters and start states to free runs, by Levenberg–Marquardt.

use super::law::State;
use super::run::{Motion, Piece, Runnable};
use crate::LearnError;
use crate::flow::Running;
use least_squares::{LeastSquares, Linearized, Method, Minimum};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Parameters of a law, and the start state of each piece.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Point {
    pub(super) parameters: Vec<f64>,
    pub(super) starts: Vec<State>,
}

/// Free runs to be fitted.
pub(super) struct Runs<'a> {
    pub(super) law: &'a dyn Runnable,
    pub(super) pieces: &'a [Piece],
    pub(super) running: &'a Running,
    /// Typical sizes of the parameters.
    pub(super) sizes: &'a [f64],
    /// Typical sizes of the states.
    pub(super) state_sizes: State,
    /// Indices of the parameters that are fitted.
    pub(super) free: &'a [usize],
    /// Typical size of the observed quantity.
    pub(super) spread: f64,
    /// Prior of the hidden states at the starts.
    pub(super) prior: Option<Prior>,
}

/// Prior of a hidden state before a stretch is seen: its mean and standard deviation, and how far the law is off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Prior {
    pub(super) mean: f64,
    pub(super) spread: f64,
    /// Root mean square error of the law's runs.
    pub(super) error: f64,
}

impl Prior {
    /// Returns the prior of a law's motions with a root mean square error; `None` if the law has no hidden state.
    pub(super) fn of(motions: &[Motion], error: f64) -> Option<Self> {
        let all = || motions.iter().flat_map(|motion| motion.hidden.iter().copied());
        let count = all().count().max(1) as f64;
        let mean = all().sum::<f64>() / count;
        let spread = (all().map(|hidden| (hidden - mean).powi(2)).sum::<f64>() / count).sqrt();
        (spread > 0.0 && error.is_finite()).then_some(Self { mean, spread, error })
    }
}

/// Number that is fitted: its place, and its change at a step of one.
#[derive(Debug, Clone, Copy)]
struct Free {
    place: Place,
    size: f64,
}

#[derive(Debug, Clone, Copy)]
enum Place {
    Parameter(usize),
    Start { piece: usize, state: usize },
}

/// Least-squares problem about a point.
struct Problem<'a> {
    runs: &'a Runs<'a>,
    base: &'a Point,
    free: Vec<Free>,
}

/// Relative step of a difference quotient.
const STEP: f64 = 1e-6;

/// Relative step by which the effect of a number is measured before the fit.
const TRIAL: f64 = 1e-4;

impl Runs<'_> {
    /// Returns the free run of every piece.
    pub(super) fn motions(&self, point: &Point) -> Vec<Motion> {
        let run = |(piece, start): (&Piece, &State)| {
            self.law.motion(&point.parameters, *start, piece, self.running)
        };
        self.pieces.iter().zip(&point.starts).map(run).collect()
    }

    /// Returns predicted minus observed values, in units of the spread, and after them what contradicts the prior.
    fn residuals(&self, point: &Point) -> DVector<f64> {
        let motions = self.motions(point);
        let pairs = self.pieces.iter().zip(&motions);
        let of = |(piece, motion): (&Piece, &Motion)| {
            let pairs = motion.positions.iter().zip(&piece.values);
            pairs.map(|(predicted, observed)| (predicted - observed) / self.spread).collect::<Vec<f64>>()
        };
        let starts = point.starts.iter().zip(self.prior);
        let known = starts.map(|(start, prior)| {
            prior.error / self.spread * (self.law.hidden(*start) - prior.mean) / prior.spread
        });
        DVector::from_vec(pairs.flat_map(of).chain(known).collect())
    }

    /// Fits the free parameters and all start states. `observe` gets the number of steps and the root mean square
    /// error, and may stop the fit.
    ///
    /// # Errors
    /// None at present; the least-squares method passes on those of a problem.
    pub(super) fn fit(
        &self,
        from: &Point,
        max_steps: u64,
        mut observe: impl FnMut(u64, f64) -> ControlFlow<()>,
    ) -> Result<(Point, Minimum), LearnError> {
        let problem = Problem { runs: self, base: from, free: self.scaled(from) };
        let count: usize = self.pieces.iter().map(|piece| piece.values.len()).sum();
        let method = Method { max_steps, tolerance: 1e-9, ..Method::NIELSEN };
        let start = DVector::zeros(problem.free.len());
        let minimum = method.minimize(&problem, &start, |state| {
            observe(state.step, self.spread * (state.loss / count.max(1) as f64).sqrt())
        })?;
        Ok((problem.point(&minimum.parameters), minimum))
    }

    /// Returns the fitted numbers, each scaled so that a step of one changes the run by about its spread.
    fn scaled(&self, point: &Point) -> Vec<Free> {
        let parameters =
            self.free.iter().filter_map(|&at| Some((Place::Parameter(at), *self.sizes.get(at)?)));
        let starts = (0..point.starts.len()).flat_map(|piece| {
            let sizes = self.state_sizes.into_iter().take(self.law.states()).enumerate();
            sizes.map(move |(state, size)| (Place::Start { piece, state }, size))
        });
        let at = self.residuals(point);
        let scaled = |(place, size): (Place, f64)| {
            let moved = self.residuals(&point.moved(place, TRIAL * size));
            let effect = (moved - &at).norm() / (at.len().max(1) as f64).sqrt() / TRIAL;
            // A number without an effect, or with one beyond all bounds, keeps its size.
            let size = if effect.is_normal() { size / effect.clamp(1e-3, 1e6) } else { size };
            Free { place, size }
        };
        parameters.chain(starts).map(scaled).collect()
    }
}

impl Point {
    fn moved(&self, place: Place, by: f64) -> Self {
        let mut moved = self.clone();
        let number = match place {
            Place::Parameter(at) => moved.parameters.get_mut(at),
            Place::Start { piece, state } => moved.starts.get_mut(piece).and_then(|own| own.get_mut(state)),
        };
        if let Some(number) = number {
            *number += by;
        }
        moved
    }
}

impl Problem<'_> {
    fn point(&self, steps: &DVector<f64>) -> Point {
        let moves = self.free.iter().zip(steps.iter());
        moves.fold(self.base.clone(), |point, (free, step)| point.moved(free.place, step * free.size))
    }
}

impl LeastSquares for Problem<'_> {
    type Error = LearnError;

    fn residuals(&self, steps: &DVector<f64>) -> Result<DVector<f64>, LearnError> {
        Ok(self.runs.residuals(&self.point(steps)))
    }

    fn linearize(&self, steps: &DVector<f64>) -> Result<Linearized, LearnError> {
        let point = self.point(steps);
        let residuals = self.runs.residuals(&point);
        let column = |free: &Free| {
            (self.runs.residuals(&point.moved(free.place, STEP * free.size)) - &residuals) / STEP
        };
        let columns: Vec<DVector<f64>> = self.free.iter().map(column).collect();
        let jacobian = DMatrix::from_columns(&columns);
        Ok(Linearized { residuals, jacobian })
    }
}
