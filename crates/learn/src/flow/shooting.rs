//! Multiple shooting: weights shared by all pieces (shooting intervals) and an initial state for each, by
//! Levenberg–Marquardt.
//!
//! The initial states are eliminated piece by piece (Schur complement), so the linear system to solve has
//! only the size of the weights. Bock, Plitt, IFAC Proceedings 17 (1984) 1603; Marquardt, SIAM Journal on
//! Applied Mathematics 11 (1963) 431.

use super::start::State;
use crate::data::Trajectory;
use crate::linear::{inverse, raised, solve};
use crate::{Context, LearnError, Step};
use least_squares::{Descent, Method};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

/// Lengths of the pieces of consecutive fits, in periods; the last one means whole parts.
pub const LENGTHS: [f64; 3] = [2.0, 8.0, 1e6];

/// Returns the name of the fit on pieces of one of these lengths.
#[must_use]
pub fn phase_name(periods: f64) -> String {
    if periods < 1e6 { format!("pieces of {periods} periods") } else { "whole parts".to_owned() }
}

/// A longer piece is preferred if its validation error is within this factor of the smallest.
const AS_GOOD: f64 = 1.02;

/// Returns the result of the longest pieces whose validation error is nearly the smallest. `found` holds the
/// errors and results, those of the shortest pieces first; `None` if there are none.
///
/// ```
/// use learn::flow::longest_as_good;
/// assert_eq!(longest_as_good(vec![(1.0, "two periods"), (1.01, "eight"), (1.5, "whole")]), Some("eight"));
/// ```
#[must_use]
pub fn longest_as_good<T>(found: Vec<(f64, T)>) -> Option<T> {
    let best = found.iter().map(|(error, _)| *error).fold(f64::INFINITY, f64::min);
    let chosen = found.into_iter().rev().find(|(error, _)| *error <= AS_GOOD * best || !best.is_finite());
    chosen.map(|(_, result)| result)
}

/// Residuals of a piece and the Jacobian of its prediction.
#[derive(Debug, Clone, PartialEq)]
pub struct Shot {
    /// Observed minus predicted position, one per sample.
    pub residuals: Vec<f64>,
    /// Row-major ∂predicted/∂(weights, initial position, initial velocity).
    pub jacobian: Vec<f64>,
}

/// Model that predicts a piece from its initial state.
pub trait Shooter {
    /// Returns the number of shared weights.
    fn weights(&self) -> usize;

    /// Predicts a piece.
    ///
    /// # Errors
    /// [`LearnError::Diverged`] if the motion diverges.
    fn shoot(&self, weights: &[f64], start: State, piece: &Trajectory) -> Result<Shot, LearnError>;
}

/// Gaussian prior of the weights, independent for each weight.
#[derive(Debug, Clone, PartialEq)]
pub struct Penalty {
    /// Prior means.
    pub mean: Vec<f64>,
    /// Inverse prior variances.
    pub precision: Vec<f64>,
}

/// Data, prior and budget of a fit.
#[derive(Clone, Copy)]
pub struct Shooting<'a> {
    /// The pieces.
    pub pieces: &'a [Trajectory],
    /// Standard deviation of a sample; it sets the weight of the prior.
    pub noise: f64,
    /// Prior of the weights; `None` for a flat prior.
    pub penalty: Option<&'a Penalty>,
    /// Largest number of steps.
    pub most_steps: u64,
    /// Name of this phase of the training, for the trace.
    pub phase: &'a str,
}

/// Result of multiple shooting.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Fitted weights.
    pub weights: Vec<f64>,
    /// Initial state of each piece.
    pub starts: Vec<State>,
    /// Sum of squared residuals.
    pub rss: f64,
    /// Number of residuals.
    pub samples: usize,
    /// Information matrix of the weights without the prior: JᵀJ of the unscaled residuals, with the initial
    /// states eliminated.
    pub information: DMatrix<f64>,
    /// Number of correlated samples that count as one independent sample: 1 + 2·Σρ² of the residuals.
    pub correlation: f64,
    /// Number of steps taken.
    pub steps: u64,
    /// `true` if the last steps hardly changed the objective, or no step could lower it.
    pub converged: bool,
}

impl Fit {
    /// Returns the root mean square residual.
    #[must_use]
    pub fn rms(&self) -> f64 {
        (self.rss / self.samples.max(1) as f64).sqrt()
    }

    /// Returns the variance of a residual, inflated for correlation; the information divided by it is the
    /// inverse covariance.
    #[must_use]
    pub fn variance(&self) -> f64 {
        let free = self.samples.saturating_sub(self.weights.len() + 2 * self.starts.len()).max(1);
        self.correlation * self.rss / free as f64
    }

    /// Returns the covariance of the weights without a prior; `None` if the data do not determine the
    /// weights.
    #[must_use]
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        inverse(&self.information).map(|inverse| inverse * self.variance())
    }
}

/// Normal equations of one piece.
struct Block {
    own: DMatrix<f64>,
    mixed: DMatrix<f64>,
    start: Matrix2<f64>,
    right: DVector<f64>,
    start_right: Vector2<f64>,
}

/// Point of the search with its normal equations.
struct Point {
    weights: Vec<f64>,
    starts: Vec<State>,
    blocks: Vec<Block>,
    residuals: Vec<Vec<f64>>,
    rss: f64,
}

/// Method of the fit.
const METHOD: Method = Method { least: 1e-12, max_damping: 1e6, ..Method::TENFOLD };

/// Relative change of the objective below which two steps in a row end the fit.
const SMALL: f64 = 1e-9;

/// Fits weights and initial states from a first guess of both.
///
/// # Errors
/// [`LearnError::Diverged`] if the first guess diverges, [`LearnError::Interrupted`].
pub fn fit(
    shooter: &dyn Shooter,
    shooting: &Shooting<'_>,
    weights: Vec<f64>,
    starts: Vec<State>,
    context: &Context<'_>,
) -> Result<Fit, LearnError> {
    let mut point = shooting.at(shooter, weights, starts)?;
    let method = Method { max_steps: context.steps(shooting.most_steps), ..METHOD };
    let mut descent = Descent::new(method);
    let mut small = 0;
    while small < 2
        && let Ok(damping) = descent.next_damping()
    {
        context.check()?;
        let next = shooting.step(&point, damping);
        let next = next.and_then(|(weights, starts)| shooting.at(shooter, weights, starts).ok());
        if descent.advance(&mut point, next, |point| shooting.objective(point)) {
            small = if descent.last_gain < SMALL { small + 1 } else { 0 };
        }
        let rms = (point.rss / shooting.samples().max(1) as f64).sqrt();
        let phase = shooting.phase.to_owned();
        (context.observe)(&Step { step: descent.steps, phase, train: rms, validation: None });
    }
    let count = shooter.weights();
    let (information, _) =
        reduced(&point.blocks, count, 0.0).unwrap_or((DMatrix::zeros(count, count), DVector::zeros(count)));
    Ok(Fit {
        information,
        correlation: correlation(&point.residuals),
        samples: shooting.samples(),
        rss: point.rss,
        weights: point.weights,
        starts: point.starts,
        steps: descent.steps,
        converged: small >= 2 || descent.is_converged(),
    })
}

impl Shooting<'_> {
    fn samples(&self) -> usize {
        self.pieces.iter().map(Trajectory::len).sum()
    }

    fn at(&self, shooter: &dyn Shooter, weights: Vec<f64>, starts: Vec<State>) -> Result<Point, LearnError> {
        let count = shooter.weights();
        let (mut blocks, mut residuals, mut rss) = (Vec::new(), Vec::new(), 0.0);
        for (piece, start) in self.pieces.iter().zip(&starts) {
            let shot = shooter.shoot(&weights, *start, piece)?;
            rss += shot.residuals.iter().map(|residual| residual * residual).sum::<f64>();
            blocks.push(block(&shot, count));
            residuals.push(shot.residuals);
        }
        Ok(Point { weights, starts, blocks, residuals, rss })
    }

    fn objective(&self, point: &Point) -> f64 {
        let Some(penalty) = self.penalty else { return point.rss };
        let away = point.weights.iter().zip(&penalty.mean).zip(&penalty.precision);
        let prior: f64 = away.map(|((weight, mean), precision)| precision * (weight - mean).powi(2)).sum();
        point.rss + self.noise * self.noise * prior
    }

    /// Returns the next point, by a damped step.
    fn step(&self, point: &Point, damping: f64) -> Option<(Vec<f64>, Vec<State>)> {
        let count = point.weights.len();
        let (mut matrix, mut right) = reduced(&point.blocks, count, damping)?;
        if let Some(penalty) = self.penalty {
            let variance = self.noise * self.noise;
            let precision = DVector::from_iterator(count, penalty.precision.iter().map(|own| own * variance));
            let away = point.weights.iter().zip(&penalty.mean).map(|(weight, mean)| weight - mean);
            right -= precision.component_mul(&DVector::from_iterator(count, away));
            matrix += DMatrix::from_diagonal(&precision);
        }
        let change = if count == 0 { DVector::zeros(0) } else { solve(&raised(&matrix, damping), &right)? };
        let weights: Vec<f64> = point.weights.iter().zip(change.iter()).map(|(old, by)| old + by).collect();
        let starts = point.starts.iter().zip(&point.blocks).map(|(start, block)| {
            let right = block.start_right - (block.mixed.tr_mul(&change)).fixed_rows::<2>(0);
            let by = damped(&block.start, damping).try_inverse()? * right;
            Some(State { position: start.position + by.x, velocity: start.velocity + by.y })
        });
        let starts: Vec<State> = starts.collect::<Option<_>>()?;
        weights.iter().all(|weight| weight.is_finite()).then_some((weights, starts))
    }
}

fn damped(matrix: &Matrix2<f64>, damping: f64) -> Matrix2<f64> {
    matrix + Matrix2::from_diagonal(&matrix.diagonal()) * (damping + 1e-14)
}

fn block(shot: &Shot, count: usize) -> Block {
    let rows = shot.residuals.len();
    let jacobian = DMatrix::from_row_slice(rows, count + 2, &shot.jacobian);
    let residuals = DVector::from_column_slice(&shot.residuals);
    let normal = jacobian.tr_mul(&jacobian);
    let right = jacobian.tr_mul(&residuals);
    Block {
        own: normal.view((0, 0), (count, count)).into_owned(),
        mixed: normal.view((0, count), (count, 2)).into_owned(),
        start: normal.fixed_view::<2, 2>(count, count).into_owned(),
        right: right.rows(0, count).into_owned(),
        start_right: right.fixed_rows::<2>(count).into_owned(),
    }
}

/// Returns the normal equations of the weights with the initial states eliminated.
fn reduced(blocks: &[Block], count: usize, damping: f64) -> Option<(DMatrix<f64>, DVector<f64>)> {
    let (mut matrix, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
    for block in blocks {
        let inverse = damped(&block.start, damping).try_inverse()?;
        let gain = &block.mixed * inverse;
        matrix += &block.own - &gain * block.mixed.transpose();
        right += &block.right - gain * block.start_right;
    }
    Some((matrix, right))
}

/// Returns 1 + 2·Σρ² over the lags within each piece, averaged with the pieces' lengths as weights: the
/// number of samples that count as one when sums of squares are compared.
///
/// Unlike a sum of ρ, it does not cancel if the correlation oscillates.
fn correlation(pieces: &[Vec<f64>]) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for residuals in pieces {
        let power: f64 = residuals.iter().map(|residual| residual * residual).sum();
        if power == 0.0 {
            continue;
        }
        let most = (residuals.len() / 4).min(400);
        let count = residuals.len() as f64;
        // White noise alone has an expected ρ² of about 1/n at every lag.
        let square = |lag: usize| {
            let product: f64 = residuals.iter().zip(residuals.iter().skip(lag)).map(|(a, b)| a * b).sum();
            (product / power).powi(2) - 1.0 / count
        };
        sum += count * (1.0 + 2.0 * (1..most).map(square).sum::<f64>()).max(1.0);
        total += count;
    }
    if total == 0.0 { 1.0 } else { sum / total }
}
