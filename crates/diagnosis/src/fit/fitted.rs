//! What a fit ends with, and where it begins.

use crate::data::segments::Data;
use crate::model::hypothesis::Hypothesis;
use crate::noise::statistics::autocorrelation_time;
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

impl Fit {
    pub(crate) fn samples(&self) -> usize {
        self.residuals.iter().map(DVector::len).sum()
    }

    /// Residuals of all segments, one after the other.
    pub(crate) fn stacked(&self) -> impl Iterator<Item = f64> + '_ {
        self.residuals.iter().flat_map(|segment| segment.iter().copied())
    }

    /// Number of parameters that are fitted to all segments.
    pub(crate) fn globals(&self) -> usize {
        self.point.globals.len()
    }

    /// Degrees of freedom of the residual.
    pub(crate) fn freedom(&self) -> f64 {
        self.point.freedom(self.samples())
    }

    /// Log likelihood that other squares of the same samples are ahead of this fit's, tempered by an autocorrelation time.
    pub(crate) fn nats_behind(&self, squares: f64, time: f64) -> f64 {
        let worth = self.samples() as f64 / time;
        0.5 * worth * (self.squares.max(f64::MIN_POSITIVE) / squares.max(f64::MIN_POSITIVE)).ln()
    }

    pub(crate) fn autocorrelation_time(&self) -> f64 {
        let pieces: Vec<&[f64]> = self.residuals.iter().map(DVector::as_slice).collect();
        autocorrelation_time(&pieces)
    }
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
