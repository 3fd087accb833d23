//! Regression of increments from swing to swing. The errors are those of the turning points plus a random
//! walk.
//!
//! An increment contains the errors of the two turning points that it spans, with opposite signs, so these
//! errors do not add up over the record. The discrepancy of each swing, which no law explains, does add up.
//! The ratio of the two variances is unknown: the evidence is averaged over a grid of ratios, and the common
//! scale is integrated out.

#![allow(
    clippy::indexing_slicing,
    reason = "every increment has its variance and covariances, every term its column"
)]

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::gamma::ln_gamma;
use std::f64::consts::PI;

/// Increments of one run of swings.
#[derive(Debug, Clone, Default)]
pub(crate) struct Increments {
    pub(crate) values: Vec<f64>,
    /// One list per term, each as long as `values`.
    pub(crate) terms: Vec<Vec<f64>>,
    /// Covariance of the measured values: variances, and covariances with the next and the next but one.
    pub(crate) covariance: [Vec<f64>; 3],
}

/// Prior distribution of a term's coefficient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Prior {
    /// Flat prior; the term is part of every hypothesis.
    Always,
    /// Uniform from 0 to a largest value.
    UpTo(f64),
    /// Uniform between minus and plus a largest value.
    Within(f64),
}

/// Hypothesis: the terms that act, its log evidence, and the coefficients (0 for terms that do not act).
#[derive(Debug, Clone)]
pub(crate) struct Hypothesis {
    pub(crate) acts: Vec<bool>,
    pub(crate) evidence: f64,
    pub(crate) coefficients: Vec<f64>,
}

/// Exponents of the grid of ratios, in half powers of ten: the variance of the discrepancy over that of a
/// measured increment. The ratio 0 is added.
const RATIOS: std::ops::RangeInclusive<i32> = -12..=6;

/// Inner products of the whitened increments at one ratio.
struct Whitened {
    normal: DMatrix<f64>,
    right: DVector<f64>,
    squares: f64,
    log_determinant: f64,
    count: usize,
}

/// Returns all sets of terms that satisfy `allowed`, with their evidence; empty if there are too few
/// increments.
pub(crate) fn hypotheses(
    runs: &[Increments],
    priors: &[Prior],
    allowed: &dyn Fn(&[bool]) -> bool,
) -> Vec<Hypothesis> {
    let scale = typical_variance(runs);
    let whitened: Vec<Whitened> = std::iter::once(0.0)
        .chain(RATIOS.map(|power| libm::pow(10_f64, 0.5 * f64::from(power))))
        .filter_map(|ratio| whiten(runs, priors.len(), ratio, scale))
        .collect();
    let subsets = 0..1_usize << priors.len();
    subsets
        .map(|bits| (0..priors.len()).map(|at| bits >> at & 1 == 1).collect::<Vec<bool>>())
        .filter(|acts| acts.iter().zip(priors).all(|(acts, prior)| *acts || *prior != Prior::Always))
        .filter(|acts| allowed(acts))
        .filter_map(|acts| hypothesis(&whitened, priors, &acts))
        .collect()
}

/// Returns the log evidence of the best set that satisfies `has` minus that of the best set that does not;
/// `None` if either is missing.
pub(crate) fn by_replacement(found: &[Hypothesis], has: &dyn Fn(&[bool]) -> bool) -> Option<f64> {
    let best = |wanted: bool| {
        let evidences = found.iter().filter(|one| has(&one.acts) == wanted).map(|one| one.evidence);
        evidences.reduce(f64::max)
    };
    Some(best(true)? - best(false)?)
}

fn typical_variance(runs: &[Increments]) -> f64 {
    let all: Vec<f64> =
        runs.iter().flat_map(|run| run.covariance.iter().take(1).flatten().copied()).collect();
    crate::noise::statistics::median(&all).max(f64::MIN_POSITIVE)
}

fn whiten(runs: &[Increments], terms: usize, ratio: f64, scale: f64) -> Option<Whitened> {
    let mut whitened = Whitened {
        normal: DMatrix::zeros(terms, terms),
        right: DVector::zeros(terms),
        squares: 0.0,
        log_determinant: 0.0,
        count: 0,
    };
    for run in runs {
        let factor = Banded::of(&run.covariance, ratio * scale)?;
        let values = factor.solve(&run.values);
        let columns: Vec<Vec<f64>> = run.terms.iter().map(|term| factor.solve(term)).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        debug_assert_eq!(columns.len(), terms);
        whitened.normal += DMatrix::from_fn(terms, terms, |row, column| dot(&columns[row], &columns[column]));
        whitened.right += DVector::from_fn(terms, |row, _| dot(&columns[row], &values));
        whitened.squares += dot(&values, &values);
        whitened.log_determinant += factor.log_determinant();
        whitened.count += run.values.len();
    }
    Some(whitened)
}

/// Lower Cholesky factor of a covariance matrix with two off-diagonals on either side.
struct Banded {
    diagonal: Vec<f64>,
    next: Vec<f64>,
    second: Vec<f64>,
}

impl Banded {
    fn of(covariance: &[Vec<f64>; 3], added: f64) -> Option<Self> {
        let [variances, first, second] = covariance;
        let mut factor = Self { diagonal: Vec::new(), next: Vec::new(), second: Vec::new() };
        for (row, variance) in variances.iter().enumerate() {
            // Entries of this row: two before, one before, and the diagonal.
            let far = if row >= 2 { second[row - 2] / factor.diagonal[row - 2] } else { 0.0 };
            let near = if row >= 1 {
                (first[row - 1] - far * factor.next[row - 1]) / factor.diagonal[row - 1]
            } else {
                0.0
            };
            // A part in 10⁹ keeps a chain of canceling increments from being singular.
            let own = variance * (1.0 + 1e-9) + added - near * near - far * far;
            if own.is_nan() || own <= 0.0 {
                return None;
            }
            factor.diagonal.push(own.sqrt());
            factor.next.push(near);
            factor.second.push(far);
        }
        Some(factor)
    }

    fn solve(&self, values: &[f64]) -> Vec<f64> {
        let mut solved: Vec<f64> = Vec::with_capacity(values.len());
        let (mut second, mut first) = (0.0, 0.0);
        for (((diagonal, near), far), value) in
            self.diagonal.iter().zip(&self.next).zip(&self.second).zip(values)
        {
            let own = (value - near * first - far * second) / diagonal;
            (second, first) = (first, own);
            solved.push(own);
        }
        solved
    }

    fn log_determinant(&self) -> f64 {
        2.0 * self.diagonal.iter().map(|entry| libm::log(*entry)).sum::<f64>()
    }
}

fn hypothesis(whitened: &[Whitened], priors: &[Prior], acts: &[bool]) -> Option<Hypothesis> {
    let places: Vec<usize> = acts.iter().enumerate().filter(|(_, acts)| **acts).map(|(at, _)| at).collect();
    let fits: Vec<(f64, Vec<f64>)> =
        whitened.iter().filter_map(|one| evidence(one, priors, &places)).collect();
    let (most, own) = fits.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let sum: f64 = fits.iter().map(|(log, ..)| libm::exp(log - most)).sum();
    let mut coefficients = vec![0.0; acts.len()];
    for (place, estimate) in places.iter().zip(own) {
        coefficients[*place] = *estimate;
    }
    Some(Hypothesis {
        acts: acts.to_vec(),
        evidence: most + libm::log(sum / whitened.len() as f64),
        coefficients,
    })
}

/// Returns the log evidence of a set at one ratio, with scale and coefficients integrated out, and the
/// coefficients.
fn evidence(whitened: &Whitened, priors: &[Prior], places: &[usize]) -> Option<(f64, Vec<f64>)> {
    let terms = places.len();
    let freedom = whitened.count.checked_sub(terms).filter(|left| *left >= 3)? as f64;
    let normal = DMatrix::from_fn(terms, terms, |row, column| whitened.normal[(places[row], places[column])]);
    let right = DVector::from_fn(terms, |row, _| whitened.right[places[row]]);
    // The units differ by many orders of magnitude: columns are scaled to length 1 before the factorization.
    let lengths = normal.diagonal().map(|square| square.max(f64::MIN_POSITIVE).sqrt());
    let unit = DMatrix::from_fn(terms, terms, |row, column| {
        normal[(row, column)] / (lengths[row] * lengths[column])
    });
    let factor = unit.cholesky()?;
    let solved = factor.solve(&right.component_div(&lengths));
    let squares =
        (whitened.squares - solved.dot(&right.component_div(&lengths))).max(1e-12 * whitened.squares);
    let inverse = factor.inverse();
    let log_determinant = 2.0
        * factor
            .l_dirty()
            .diagonal()
            .iter()
            .zip(lengths.iter())
            .map(|(l, length)| libm::log(l * length))
            .sum::<f64>();
    let variance = squares / freedom;
    let mut log = -0.5 * (whitened.log_determinant + log_determinant) + ln_gamma(0.5 * freedom)
        - 0.5 * freedom * libm::log(PI * squares);
    let mut estimates = Vec::with_capacity(terms);
    for (at, place) in places.iter().enumerate() {
        let value = solved[at] / lengths[at];
        let error = (variance * inverse[(at, at)]).sqrt() / lengths[at];
        log += match priors[*place] {
            Prior::Always => 0.0,
            Prior::UpTo(most) => log_between(-value / error, (most - value) / error) - libm::log(most),
            Prior::Within(most) => {
                log_between((-most - value) / error, (most - value) / error) - libm::log(2.0 * most)
            }
        };
        estimates.push(value);
    }
    log.is_finite().then_some((log, estimates))
}

/// Returns the logarithm of the probability that a standard normal variable lies between two limits.
fn log_between(low: f64, high: f64) -> f64 {
    // The tail on the side of the interval keeps its digits.
    let (near, far) = if low > 0.0 {
        (low, high)
    } else if high < 0.0 {
        (-high, -low)
    } else {
        (0.0, 0.0)
    };
    if near > 6.0 {
        return -0.5 * near * near - libm::log(near * (2.0 * PI).sqrt());
    }
    let below = |z: f64| Normal::standard().cdf(z);
    let between = if near > 0.0 { below(-near) - below(-far) } else { below(high) - below(low) };
    libm::log(between.max(f64::MIN_POSITIVE))
}
