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
    /// Returns how many numbers these are.
    fn count(&self) -> usize {
        self.globals.len() + self.starts.iter().map(Vec::len).sum::<usize>()
    }

    /// Returns the degrees of freedom that remain of so many samples, at least 1.
    pub(crate) fn freedom(&self, samples: usize) -> f64 {
        (samples as f64 - self.count() as f64).max(1.0)
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

    /// Returns the factor between [`Self::inverse`] and a covariance: the squares of the residual over its degrees of freedom.
    /// Of `n` samples with the autocorrelation time `τ`, `n/τ` are independent, and each fitted number takes one of these.
    pub(crate) fn variance(&self) -> f64 {
        self.variance_with(self.autocorrelation_time())
    }

    /// Returns the same with an autocorrelation time that is known.
    pub(crate) fn variance_with(&self, time: f64) -> f64 {
        let independent = self.samples() as f64 / time;
        self.squares / (independent - self.point.count() as f64).max(1.0)
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

#[cfg(test)]
mod tests {
    use super::{Fit, Point};
    use crate::model::hypothesis::Hypothesis;
    use dynamics::Nominal;
    use nalgebra::{DMatrix, DVector};
    use rand_distr::{Distribution, StandardNormal};

    /// Correlation of neighboring errors, number of segments, and samples of each.
    const CORRELATION: f64 = 0.9;
    const SEGMENTS: usize = 10;
    const LENGTH: usize = 100;

    /// Returns the residuals of segments of an AR(1) process of variance 1, less their own means.
    fn about_means(generator: &mut impl rand::Rng) -> Vec<DVector<f64>> {
        let mut normal = || -> f64 { StandardNormal.sample(&mut *generator) };
        let new = libm::sqrt(1.0 - CORRELATION * CORRELATION);
        let mut error = normal();
        let segment = |_| {
            let own = DVector::from_fn(LENGTH, |_, _| {
                error = CORRELATION * error + new * normal();
                error
            });
            let mean = own.mean();
            own.add_scalar(-mean)
        };
        (0..SEGMENTS).map(segment).collect()
    }

    /// Ten means of 1,000 samples, which are 53 independent ones, take a fifth of the squares.
    #[test]
    fn what_a_fit_takes_of_correlated_errors_is_given_back() {
        let time = (1.0 + CORRELATION) / (1.0 - CORRELATION);
        let nominal = Nominal::new(1.0, 0.1, 1.0, 0.0).unwrap();
        let hypothesis =
            Hypothesis { nominal, known: Vec::new(), calibrated: Vec::new(), candidates: Vec::new() };
        let mut generator = seed::Seed::new(1).child("errors").generator();
        let draws = 400;
        let variance = |_| {
            let residuals = about_means(&mut generator);
            let fit = Fit {
                hypothesis: hypothesis.clone(),
                point: Point { globals: Vec::new(), starts: vec![vec![0.0]; SEGMENTS] },
                squares: residuals.iter().map(DVector::norm_squared).sum(),
                residuals,
                converged: true,
                at_bound: Vec::new(),
                inverse: DMatrix::zeros(0, 0),
            };
            fit.variance_with(time)
        };
        let mean = (0..draws).map(variance).sum::<f64>() / f64::from(draws);
        assert!((mean / time - 1.0).abs() < 0.05, "{mean} instead of {time}");
    }
}
