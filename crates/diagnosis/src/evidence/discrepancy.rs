//! Free latent torque: an upper bound of what a torque without a name could still explain.
//!
//! It is a smooth function of position, velocity, time and the input in a tensor basis of low order, added to
//! the fitted system to first order. Its coefficients are fitted to interleaved segments and scored on the
//! others. If it clearly beats the best named effects, something without a name acts; otherwise nothing
//! smooth is left.

use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::linear::dictionary::{Acting, Smooth, columns_of};
use crate::linear::projection::{Projection, jacobians};
use crate::linear::tangent::{Path, matrix};
use crate::matrices::{ridged, solve};
use dynamics::DynamicsError;
use nalgebra::{DMatrix, DVector};

/// Highest total degree in position and velocity.
const DEGREE: i32 = 5;

/// Weight of the ridge penalty, relative to the columns' own squares.
const RIDGE: f64 = 1e-4;

/// Evaluates a Chebyshev polynomial of the first kind.
fn chebyshev(degree: i32, x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    libm::cos(f64::from(degree) * libm::acos(x))
}

/// Highest degree in the input.
const INPUT_DEGREE: i32 = 5;

/// Returns smooth functions of position, velocity and time, and of the input if there is one, each of order
/// one. `rest` is the rest angle.
pub(crate) fn basis(data: &Data, rest: f64) -> Vec<Smooth> {
    let (a, v, t) = (1.05 * data.facts.amplitude, 1.05 * data.facts.speed, data.facts.duration);
    let mut basis: Vec<Smooth> = Vec::new();
    for i in 0..=DEGREE {
        for j in 0..=DEGREE - i {
            if i + j >= 2 {
                basis.push(Box::new(move |m| {
                    chebyshev(i, (m.position - rest) / a) * chebyshev(j, m.velocity / v)
                }));
            }
        }
    }
    // Friction has a jump at rest that no polynomial follows.
    basis.push(Box::new(|m| m.velocity.signum()));
    basis.push(Box::new(move |m| m.velocity.signum() * ((m.position - rest) / a)));
    for degree in 1..=2 {
        for (i, j) in [(0, 0), (1, 0), (0, 1)] {
            basis.push(Box::new(move |m| {
                chebyshev(degree, 2.0 * m.time / t - 1.0)
                    * chebyshev(i, (m.position - rest) / a)
                    * chebyshev(j, m.velocity / v)
            }));
        }
    }
    if data.facts.input_torque > 0.0 {
        let u = 1.05 * data.facts.input_torque;
        for degree in 2..=INPUT_DEGREE {
            basis.push(Box::new(move |m| chebyshev(degree, m.input / u)));
        }
        for (i, j) in [(1, 0), (0, 1)] {
            basis.push(Box::new(move |m| {
                m.input / u * chebyshev(i, (m.position - rest) / a) * chebyshev(j, m.velocity / v)
            }));
        }
        basis.push(Box::new(move |m| m.input / u * chebyshev(1, 2.0 * m.time / t - 1.0)));
    }
    basis
}

/// Returns the held-out residuals of a fit after the latent torque, by segment: fitted to the even segments
/// and scored on the odd ones, and the other way round. `paths` are the fit's.
pub(crate) fn ceiling(data: &Data, fit: &Fit, paths: &[Path]) -> Result<Vec<DVector<f64>>, DynamicsError> {
    let rest = data.facts.rest(&fit.point.globals, &fit.hypothesis);
    let latent = columns_of(paths, data.quantity, &basis(data, rest), Acting::Torque);
    let jacobians = jacobians(data, &fit.hypothesis, &fit.point)?;
    let starts = fit.hypothesis.start_length();
    let globals = fit.globals();
    let own: Vec<DMatrix<f64>> = jacobians.iter().map(|j| j.columns(0, starts).clone_owned()).collect();
    let projection = Projection::from_jacobians(&own, starts);
    let rows = projection.rows();
    let latent = matrix(rows, &latent);
    let mut columns = DMatrix::zeros(rows, globals + latent.ncols() + 1);
    let mut at = 0;
    for (jacobian, residual) in jacobians.iter().zip(&fit.residuals) {
        let count = jacobian.nrows();
        columns.view_mut((at, 0), (count, globals)).copy_from(&jacobian.columns(starts, globals));
        columns.view_mut((at, globals), (count, latent.ncols())).copy_from(&latent.rows(at, count));
        columns.view_mut((at, globals + latent.ncols()), (count, 1)).copy_from(residual);
        at += count;
    }
    projection.apply(&mut columns);
    let width = globals + latent.ncols();
    let mut gram = [DMatrix::zeros(width, width), DMatrix::zeros(width, width)];
    let mut right = [DMatrix::zeros(width, 1), DMatrix::zeros(width, 1)];
    let mut at = 0;
    for (index, jacobian) in jacobians.iter().enumerate() {
        let block = columns.rows(at, jacobian.nrows());
        let side = index % 2;
        if let (Some(gram), Some(right)) = (gram.get_mut(side), right.get_mut(side)) {
            *gram += block.columns(0, width).tr_mul(&block.columns(0, width));
            *right += block.columns(0, width).tr_mul(&block.columns(width, 1));
        }
        at += jacobian.nrows();
    }
    let coefficients: Vec<DMatrix<f64>> = gram
        .iter()
        .zip(&right)
        .map(|(gram, right)| {
            let gram = ridged(gram, globals..width, RIDGE);
            solve(&gram, right).unwrap_or_else(|| DMatrix::zeros(width, 1))
        })
        .collect();
    let mut at = 0;
    let mut residuals = Vec::with_capacity(jacobians.len());
    for (index, jacobian) in jacobians.iter().enumerate() {
        let block = columns.rows(at, jacobian.nrows());
        let mut residual = block.column(width).clone_owned();
        if let Some(coefficients) = coefficients.get(1 - index % 2) {
            residual -= (block.columns(0, width) * coefficients).column(0);
        }
        residuals.push(residual);
        at += jacobian.nrows();
    }
    Ok(residuals)
}
