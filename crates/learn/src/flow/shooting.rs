//! Multiple shooting: weights shared by all pieces, a start state for each, by Levenberg–Marquardt.
//!
//! Start states are eliminated piece by piece (Schur's complement), so a step costs no more for many pieces than for
//! few. Bock, Plitt, IFAC Proceedings 17 (1984) 1603; Marquardt, SIAM Journal on Applied Mathematics 11 (1963) 431.

use super::start::State;
use crate::data::Trajectory;
use crate::linear::{inverse, raised, solve};
use crate::{Context, LearnError, Step};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

/// Residuals of a piece and the Jacobian of its prediction.
#[derive(Debug, Clone, PartialEq)]
pub struct Shot {
    /// Observed less predicted, one for each sample.
    pub residuals: Vec<f64>,
    /// Row-major ∂predicted/∂(weights, start position, start velocity).
    pub jacobian: Vec<f64>,
}

/// What predicts a piece from its start.
pub trait Shooter {
    /// Number of shared weights.
    fn weights(&self) -> usize;

    /// Predicts a piece.
    ///
    /// # Errors
    /// [`LearnError::Diverged`] where the motion runs away.
    fn shoot(&self, weights: &[f64], start: State, piece: &Trajectory) -> Result<Shot, LearnError>;
}

/// A Gaussian prior of the weights, independent of each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Penalty {
    /// Means.
    pub mean: Vec<f64>,
    /// One over the variances.
    pub precision: Vec<f64>,
}

/// What is fitted, and how long.
#[derive(Clone, Copy)]
pub struct Shooting<'a> {
    /// The pieces.
    pub pieces: &'a [Trajectory],
    /// Standard deviation of a sample, which the prior is weighed against.
    pub noise: f64,
    /// Prior of the weights, where there is one.
    pub penalty: Option<&'a Penalty>,
    /// Most steps.
    pub most_steps: u64,
    /// Name of this part of a training, for the trace.
    pub phase: &'a str,
}

/// A fit by multiple shooting.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The weights.
    pub weights: Vec<f64>,
    /// Start state of each piece.
    pub starts: Vec<State>,
    /// Sum of squared residuals.
    pub rss: f64,
    /// Number of residuals.
    pub samples: usize,
    /// Information on the weights: JᵀJ with the start states eliminated, without prior, of residuals in their unit.
    pub information: DMatrix<f64>,
    /// Samples that count as one, by the correlation of the residuals: 1 + 2·Σρ².
    pub correlation: f64,
    /// Steps taken.
    pub steps: u64,
    /// Whether the last step changed next to nothing.
    pub converged: bool,
}

impl Fit {
    /// Root mean square residual.
    #[must_use]
    pub fn rms(&self) -> f64 {
        (self.rss / self.samples.max(1) as f64).sqrt()
    }

    /// Variance of a residual, widened for correlation: what the information is divided by.
    #[must_use]
    pub fn variance(&self) -> f64 {
        let free = self.samples.saturating_sub(self.weights.len() + 2 * self.starts.len()).max(1);
        self.correlation * self.rss / free as f64
    }

    /// Covariance of the weights without a prior; `None` where the data leave a direction open.
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

/// A point of the search with its normal equations.
struct Point {
    weights: Vec<f64>,
    starts: Vec<State>,
    blocks: Vec<Block>,
    residuals: Vec<Vec<f64>>,
    rss: f64,
}

/// Relative change of the objective below which a fit is done.
const SMALL: f64 = 1e-9;

/// Fits weights and start states from a first guess of both.
///
/// # Errors
/// [`LearnError::Diverged`] where the first guess runs away, [`LearnError::Interrupted`].
pub fn fit(
    shooter: &dyn Shooter,
    shooting: &Shooting<'_>,
    weights: Vec<f64>,
    starts: Vec<State>,
    context: &Context<'_>,
) -> Result<Fit, LearnError> {
    let mut point = shooting.at(shooter, weights, starts)?;
    let (mut damping, mut converged, mut steps) = (1e-3, false, 0);
    let mut small = 0;
    while steps < context.steps(shooting.most_steps) && !converged {
        context.check()?;
        steps += 1;
        let before = shooting.objective(&point);
        let next = shooting.step(&point, damping);
        let next = next.and_then(|(weights, starts)| shooting.at(shooter, weights, starts).ok());
        match next.filter(|next| shooting.objective(next) < before) {
            Some(next) => {
                let change = (before - shooting.objective(&next)) / before.max(f64::MIN_POSITIVE);
                point = next;
                damping = (damping * 0.1).max(1e-12);
                small = if change < SMALL { small + 1 } else { 0 };
                converged = small >= 2;
            }
            None => {
                damping *= 10.0;
                converged = damping > 1e6;
            }
        }
        let rms = (point.rss / shooting.samples().max(1) as f64).sqrt();
        let phase = shooting.phase.to_owned();
        (context.observe)(&Step { step: steps, phase, train: rms, validation: None });
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
        steps,
        converged,
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

    /// The next point, by a damped step.
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

/// Normal equations of the weights with the start states eliminated.
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

/// 1 + 2·Σρ² over lags within the pieces, weighed by their lengths: samples that count as one in a comparison of sums of
/// squares. It does not cancel where the correlation swings, as a sum of ρ would.
fn correlation(pieces: &[Vec<f64>]) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for residuals in pieces {
        let power: f64 = residuals.iter().map(|residual| residual * residual).sum();
        if power == 0.0 {
            continue;
        }
        let most = (residuals.len() / 4).min(400);
        let count = residuals.len() as f64;
        // Chance alone makes ρ² about 1/n at every lag.
        let square = |lag: usize| {
            let product: f64 = residuals.iter().zip(residuals.iter().skip(lag)).map(|(a, b)| a * b).sum();
            (product / power).powi(2) - 1.0 / count
        };
        sum += count * (1.0 + 2.0 * (1..most).map(square).sum::<f64>()).max(1.0);
        total += count;
    }
    if total == 0.0 { 1.0 } else { sum / total }
}
