//! Windows of records, each with a network, and the coefficients that they share: residuals, normal
//! equations, steps.

#![allow(clippy::indexing_slicing, reason = "pieces have samples")]

use super::trajectory::Shape;
use crate::Place;
use crate::data::{DataSet, Scale, Trajectory, interpolated, local_states};
use crate::flow::{Field, Slope};
use crate::learners::library::{Library, Term};
use crate::linear::{inverse, raised, solve};
use dynamics::Hold;
use nalgebra::{DMatrix, DVector};

/// Scales that the residuals are divided by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sizes {
    /// Standard deviation of an observation.
    pub(super) noise: f64,
    /// Tolerated residual of the law, as an acceleration.
    pub(super) tolerance: f64,
}

/// The whole fitting problem.
pub(super) struct Problem<'a> {
    pub(super) shape: Shape,
    pub(super) library: &'a Library,
    pub(super) windows: Vec<Window>,
    pub(super) scale: Scale,
    /// `true` if the law has a term that jumps at turning points.
    jumps: bool,
}

/// Window of a record.
pub(super) struct Window {
    /// Scaled times and observed positions.
    observed: Vec<(f64, f64)>,
    /// Collocation points: scaled times at which the law is enforced, and the input there.
    collocation: Vec<(f64, f64)>,
    /// Half the length of the window, in seconds.
    half_s: f64,
}

/// Coefficients of the law and weights of each window's network.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Unknowns {
    pub(super) coefficients: Vec<f64>,
    pub(super) networks: Vec<Vec<f64>>,
}

/// Objective and residuals at given unknowns.
pub(super) struct Standing {
    pub(super) objective: f64,
    /// Root mean square difference between networks and observations, in the unit of the positions.
    pub(super) misfit: f64,
    /// Root mean square residual of the law, as an acceleration.
    pub(super) residual: f64,
}

/// Normal equations of one window.
struct Block {
    own: DMatrix<f64>,
    mixed: DMatrix<f64>,
    right: DVector<f64>,
}

/// Normal equations of all windows.
pub(super) struct Equations {
    blocks: Vec<Block>,
    shared: DMatrix<f64>,
    right: DVector<f64>,
}

/// Number of collocation points per sample.
const COLLOCATION: f64 = 2.0;

/// Damping just large enough to absorb rounding errors.
const NEXT_TO_NONE: f64 = 1e-11;

/// Prior precision of the networks' weights; nearly flat, but it keeps the equations solvable.
const RIDGE: f64 = 1e-6;

/// Share of the typical velocity below which a motion may be at its turning point.
const TURNING: f64 = 0.05;

/// Smallest number of samples in a window.
const LEAST: usize = 10;

/// Cuts the training part into stretches of at most about `seconds`. If they have more than about `samples`
/// samples in total, evenly chosen stretches are kept. For a law that jumps at turning points, no stretch
/// crosses one.
pub(super) fn stretches(data: &DataSet, jumps: bool, seconds: f64, samples: usize) -> Vec<Trajectory> {
    let mut found: Vec<Trajectory> = Vec::new();
    for part in &data.train {
        let mut cuts = vec![0];
        if jumps {
            let states = local_states(part, data.period_s / 8.0);
            let pairs = states.iter().zip(states.iter().skip(1));
            cuts.extend(pairs.filter(|(a, b)| a.velocity * b.velocity <= 0.0).map(|(_, b)| b.sample));
        }
        cuts.push(part.len());
        let between = cuts.iter().zip(cuts.iter().skip(1)).map(|(&from, &to)| part.part(from, to));
        found.extend(between.flat_map(|own| own.pieces(seconds)).filter(|piece| piece.len() >= LEAST));
    }
    let all: usize = found.iter().map(Trajectory::len).sum();
    let stride = all.div_ceil(samples.max(1)).max(1);
    found.into_iter().step_by(stride).collect()
}

impl Window {
    pub(super) fn new(piece: &Trajectory, hold: Hold) -> Self {
        let first = piece.times_s()[0];
        let half_s = (0.5 * piece.duration_s()).max(f64::MIN_POSITIVE);
        let scaled = |time: f64| (time - first) / half_s - 1.0;
        let observed =
            piece.times_s().iter().zip(piece.values()).map(|(time, value)| (scaled(*time), *value));
        let count = (COLLOCATION * piece.len() as f64).round().max(2.0);
        let times = (0..count as usize).map(|at| (at as f64 + 0.5) / count * 2.0 - 1.0);
        let collocation = times.map(|s| (s, input_at(piece, first + (s + 1.0) * half_s, hold)));
        Self { observed: observed.collect(), collocation: collocation.collect(), half_s }
    }
}

/// Returns the input at a time, smoothed. A held input jumps at every sample, which no smooth motion can
/// follow; its mean over the preceding interval takes its place.
fn input_at(piece: &Trajectory, time: f64, hold: Hold) -> f64 {
    let Some(input) = piece.input() else { return 0.0 };
    let at = |time: f64| interpolated(piece.times_s(), input, time);
    match hold {
        Hold::Linear | Hold::BandLimited => at(time),
        Hold::Zero => {
            let interval = piece.duration_s() / piece.len().saturating_sub(1).max(1) as f64;
            // Simpson's rule.
            (at(time - interval) + 4.0 * at(time - 0.5 * interval) + at(time)) / 6.0
        }
    }
}

/// Returns `true` for a law that jumps at turning points.
pub(super) fn jumps(library: &Library) -> bool {
    library.terms().contains(&Term::Direction)
}

impl<'a> Problem<'a> {
    pub(super) fn new(shape: Shape, library: &'a Library, pieces: &[Trajectory], data: &DataSet) -> Self {
        let windows = pieces.iter().map(|piece| Window::new(piece, data.hold)).collect();
        Self { shape, library, windows, scale: data.scale, jumps: jumps(library) }
    }

    /// Returns the scaled residuals of a window with their Jacobian, the observations first. Each row holds
    /// the derivatives with respect to network weights, then coefficients. Collocation points where the law
    /// is not enforced have no row.
    fn rows(&self, window: &Window, coefficients: &[f64], network: &[f64], sizes: Sizes) -> Rows {
        let (own, shared) = (self.shape.weights(), coefficients.len());
        let mut rows = Rows { residuals: Vec::new(), jacobian: Vec::new(), observed: window.observed.len() };
        let mut slope = Slope { weights: vec![0.0; shared], ..Slope::default() };
        for (s, value) in &window.observed {
            let ([x, ..], by) = self.shape.at(network, *s);
            let size = self.scale.position / sizes.noise;
            rows.residuals.push(size * x + (self.scale.center - value) / sizes.noise);
            rows.jacobian.extend(by.iter().map(|[by, ..]| size * by));
            rows.jacobian.extend(std::iter::repeat_n(0.0, shared));
        }
        let position = self.scale.position;
        let (rate, bend) = (position / window.half_s, position / window.half_s.powi(2));
        for (s, input) in &window.collocation {
            let ([x, v, a], by) = self.shape.at(network, *s);
            let velocity = rate * v;
            if self.jumps && velocity.abs() < TURNING * self.scale.velocity {
                continue;
            }
            let place = Place {
                position: self.scale.center + position * x,
                velocity,
                direction: velocity.signum(),
                input: *input,
            };
            let law = self.library.sloped(coefficients, &place, &mut slope);
            rows.residuals.push((bend * a - law) / sizes.tolerance);
            rows.jacobian.extend(by.iter().map(|[by_x, by_v, by_a]| {
                (bend * by_a - slope.velocity * rate * by_v - slope.position * position * by_x)
                    / sizes.tolerance
            }));
            rows.jacobian.extend(slope.weights.iter().map(|own| -own / sizes.tolerance));
        }
        debug_assert_eq!(rows.jacobian.len(), rows.residuals.len() * (own + shared));
        rows
    }

    /// Returns objective and residuals.
    pub(super) fn standing(&self, unknowns: &Unknowns, sizes: Sizes) -> Standing {
        let mut standing = Standing { objective: 0.0, misfit: 0.0, residual: 0.0 };
        let (mut observed, mut held) = (0_usize, 0_usize);
        for (window, network) in self.windows.iter().zip(&unknowns.networks) {
            let rows = self.rows(window, &unknowns.coefficients, network, sizes);
            let squares: Vec<f64> = rows.residuals.iter().map(|own| own * own).collect();
            let (of_data, of_law) = squares.split_at_checked(rows.observed).unwrap_or((&squares, &[]));
            standing.misfit += of_data.iter().sum::<f64>();
            standing.residual += of_law.iter().sum::<f64>();
            observed += of_data.len();
            held += of_law.len();
            standing.objective += RIDGE * network.iter().map(|own| own * own).sum::<f64>();
        }
        standing.objective += standing.misfit + standing.residual;
        standing.misfit = sizes.noise * (standing.misfit / observed.max(1) as f64).sqrt();
        standing.residual = sizes.tolerance * (standing.residual / held.max(1) as f64).sqrt();
        standing
    }

    /// Returns the normal equations.
    pub(super) fn equations(&self, unknowns: &Unknowns, sizes: Sizes) -> Equations {
        let (own, shared) = (self.shape.weights(), unknowns.coefficients.len());
        let mut all = Equations {
            blocks: Vec::new(),
            shared: DMatrix::zeros(shared, shared),
            right: DVector::zeros(shared),
        };
        for (window, network) in self.windows.iter().zip(&unknowns.networks) {
            let rows = self.rows(window, &unknowns.coefficients, network, sizes);
            let jacobian = DMatrix::from_row_slice(rows.residuals.len(), own + shared, &rows.jacobian);
            let right = -jacobian.tr_mul(&DVector::from_vec(rows.residuals));
            let normal = jacobian.tr_mul(&jacobian);
            let ridge = DMatrix::from_diagonal_element(own, own, RIDGE);
            all.shared += normal.view((own, own), (shared, shared));
            all.right += right.rows(own, shared);
            all.blocks.push(Block {
                own: normal.view((0, 0), (own, own)) + ridge,
                mixed: normal.view((own, 0), (shared, own)).into_owned(),
                right: right.rows(0, own) - RIDGE * DVector::from_column_slice(network),
            });
        }
        all
    }
}

/// Scaled residuals of a window, and their Jacobian.
struct Rows {
    residuals: Vec<f64>,
    jacobian: Vec<f64>,
    observed: usize,
}

impl Equations {
    /// Returns the normal matrix of the coefficients with the networks eliminated, and its right side.
    fn eliminated(&self, damping: f64) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let (mut matrix, mut right) = (raised(&self.shared, damping), self.right.clone());
        for block in &self.blocks {
            let root = raised(&block.own, damping).cholesky()?;
            matrix -= &block.mixed * root.solve(&block.mixed.transpose());
            right -= &block.mixed * root.solve(&block.right);
        }
        Some((matrix, right))
    }

    /// Returns the unknowns after a damped step (Marquardt 1963).
    pub(super) fn step(&self, from: &Unknowns, damping: f64) -> Option<Unknowns> {
        let (matrix, right) = self.eliminated(damping)?;
        let by = solve(&matrix, &right)?;
        let mut next = from.clone();
        next.coefficients.iter_mut().zip(by.iter()).for_each(|(own, by)| *own += by);
        for (network, block) in next.networks.iter_mut().zip(&self.blocks) {
            let root = raised(&block.own, damping).cholesky()?;
            let by = root.solve(&(&block.right - block.mixed.tr_mul(&by)));
            network.iter_mut().zip(by.iter()).for_each(|(own, by)| *own += by);
        }
        Some(next)
    }

    /// Returns the covariance of the coefficients with the networks left free; `None` if the data do not
    /// determine them.
    pub(super) fn covariance(&self) -> Option<DMatrix<f64>> {
        inverse(&self.eliminated(NEXT_TO_NONE)?.0)
    }
}
