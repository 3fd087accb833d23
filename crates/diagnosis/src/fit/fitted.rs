//! Starting point and result of a fit.

#![allow(clippy::indexing_slicing, reason = "matrices have a row and a column for every global parameter")]

use crate::data::segments::Data;
use crate::matrices::product;
use crate::model::candidate::Candidate;
use crate::model::hypothesis::Hypothesis;
use crate::noise::statistics::autocorrelation_time;
use nalgebra::{DMatrix, DVector};

/// Values of all that a fit moves: the global parameters, and a start state for each segment.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Point {
    pub(crate) globals: Vec<f64>,
    pub(crate) starts: Vec<Vec<f64>>,
}

impl Point {
    /// Returns the degrees of freedom that remain of so many samples, at least 1.
    pub(crate) fn freedom(&self, samples: usize) -> f64 {
        let starts: usize = self.starts.iter().map(Vec::len).sum();
        (samples as f64 - starts as f64 - self.globals.len() as f64).max(1.0)
    }
}

/// Fitted hypothesis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fit {
    pub(crate) hypothesis: Hypothesis,
    pub(crate) point: Point,
    /// Residuals by segment, observed minus predicted.
    pub(crate) residuals: Vec<DVector<f64>>,
    pub(crate) squares: f64,
    /// `true` if the fit ended before its steps were spent.
    pub(crate) converged: bool,
    /// `true` for each global parameter that ended at a limit of its range.
    pub(crate) at_bound: Vec<bool>,
    /// (JᵀJ)⁻¹ of the global parameters, start states eliminated; times the noise variance it is their
    /// covariance. Empty if only start states were moved.
    pub(crate) inverse: DMatrix<f64>,
}

impl Fit {
    pub(crate) fn samples(&self) -> usize {
        self.residuals.iter().map(DVector::len).sum()
    }

    /// Returns the residuals of all segments, one after the other.
    pub(crate) fn stacked(&self) -> impl Iterator<Item = f64> + '_ {
        self.residuals.iter().flat_map(|segment| segment.iter().copied())
    }

    /// Returns the number of global parameters, which are fitted to all segments.
    pub(crate) fn globals(&self) -> usize {
        self.point.globals.len()
    }

    /// Returns the degrees of freedom of the residual.
    pub(crate) fn freedom(&self) -> f64 {
        self.point.freedom(self.samples())
    }

    /// Returns by how many nats of log likelihood this fit lies behind one with the sum of squares `squares`
    /// on the same samples, tempered by the autocorrelation time `time`.
    pub(crate) fn nats_behind(&self, squares: f64, time: f64) -> f64 {
        let worth = self.samples() as f64 / time;
        0.5 * worth * libm::log(self.squares.max(f64::MIN_POSITIVE) / squares.max(f64::MIN_POSITIVE))
    }

    /// Returns the factor between [`Self::inverse`] and a covariance: the variance of the residual, times its
    /// autocorrelation time.
    pub(crate) fn variance(&self) -> f64 {
        self.squares / self.freedom() * self.autocorrelation_time()
    }

    /// Returns the standard errors of a law's parameters. `fitted` are its fitted parameters, which begin at index `at` of
    /// the globals.
    pub(crate) fn spread(&self, candidate: Candidate, at: usize, fitted: &[f64]) -> Vec<f64> {
        let count = fitted.len();
        let mut change = DMatrix::identity(count, count);
        for (row, column, slope) in candidate.slopes(fitted) {
            change[(row, column)] = slope;
        }
        let own = DMatrix::from_fn(count, count, |i, j| self.inverse[(at + i, at + j)]);
        let covariance = product(&change, &product(&own, &change.transpose())) * self.variance();
        covariance.diagonal().iter().map(|square| square.max(0.0).sqrt()).collect()
    }

    pub(crate) fn autocorrelation_time(&self) -> f64 {
        let pieces: Vec<&[f64]> = self.residuals.iter().map(DVector::as_slice).collect();
        autocorrelation_time(&pieces)
    }
}

/// Returns start states made from the segments' guesses.
pub(crate) fn first_starts(data: &Data, hypothesis: &Hypothesis) -> Vec<Vec<f64>> {
    data.segments.iter().map(|segment| extended(&segment.guess, hypothesis)).collect()
}

/// Extends a start state to the length that a hypothesis requires. Entries of known hidden bodies are kept if
/// present; other hidden bodies start with the body's position and velocity.
pub(crate) fn extended(start: &[f64], hypothesis: &Hypothesis) -> Vec<f64> {
    let known = start.iter().copied().take(hypothesis.least_start_length());
    let along = start.iter().copied().take(2).cycle();
    let missing = hypothesis.start_length().saturating_sub(known.len());
    known.chain(along.take(missing)).collect()
}
