//! Projection on the complement of what a fit can still move.

use crate::data::segments::Data;
use crate::fit::fitted::{Fit, Point};
use crate::matrices::product;
use crate::model::hypothesis::Hypothesis;
use crate::model::predictor::{Derivatives, Simulator};
use dynamics::DynamicsError;
use nalgebra::{DMatrix, DVector};

/// P = 1 − QQᵀ, where Q spans the sensitivities to every segment's start state and to the global parameters.
#[derive(Debug, Clone)]
pub(crate) struct Projection {
    /// First row of each segment, and an orthonormal basis of its start state's sensitivities.
    segments: Vec<(usize, DMatrix<f64>)>,
    /// Orthonormal basis of the global parameters' sensitivities, start states removed.
    globals: DMatrix<f64>,
}

/// Part of a column's norm that has to remain; otherwise the column counts as lying in the span of those
/// before it.
const DEPENDENT: f64 = 1e-9;

/// Returns orthonormal columns with the same span; dependent ones are left out.
///
/// The orthogonalization runs twice, since once is not enough for columns that are nearly dependent.
fn orthonormal(columns: DMatrix<f64>) -> DMatrix<f64> {
    let mut basis: Vec<DVector<f64>> = Vec::with_capacity(columns.ncols());
    for column in columns.column_iter() {
        let mut rest = column.clone_owned();
        let length = rest.norm();
        for _ in 0..2 {
            for unit in &basis {
                let overlap = unit.dot(&rest);
                rest.axpy(-overlap, unit, 1.0);
            }
        }
        let left = rest.norm();
        if left > DEPENDENT * length && left > 0.0 {
            basis.push(rest / left);
        }
    }
    if basis.is_empty() { DMatrix::zeros(columns.nrows(), 0) } else { DMatrix::from_columns(&basis) }
}

impl Projection {
    /// Builds the projection from the Jacobian of each segment, whose columns are those of the start state,
    /// then the global ones.
    pub(crate) fn from_jacobians(jacobians: &[DMatrix<f64>], starts: usize) -> Self {
        let globals = jacobians.iter().map(|jacobian| jacobian.ncols() - starts).fold(0, usize::max);
        let rows = jacobians.iter().map(DMatrix::nrows).sum();
        let mut all = DMatrix::zeros(rows, globals);
        let mut segments = Vec::with_capacity(jacobians.len());
        let mut at = 0;
        for jacobian in jacobians {
            segments.push((at, orthonormal(jacobian.columns(0, starts).clone_owned())));
            all.rows_mut(at, jacobian.nrows()).copy_from(&jacobian.columns(starts, globals));
            at += jacobian.nrows();
        }
        let bare = Self { segments, globals: DMatrix::zeros(rows, 0) };
        bare.apply(&mut all);
        Self { globals: orthonormal(all), ..bare }
    }

    /// Builds the projection at a fit, with its exact sensitivities.
    pub(crate) fn at(data: &Data, fit: &Fit) -> Result<Self, DynamicsError> {
        let jacobians = jacobians(data, &fit.hypothesis, &fit.point)?;
        Ok(Self::from_jacobians(&jacobians, fit.hypothesis.start_length()))
    }

    /// Projects every column.
    pub(crate) fn apply(&self, columns: &mut DMatrix<f64>) {
        for (at, basis) in &self.segments {
            let mut rows = columns.rows_mut(*at, basis.nrows());
            let overlap = basis.tr_mul(&rows);
            rows -= product(basis, &overlap);
        }
        if self.globals.ncols() > 0 {
            let overlap = self.globals.tr_mul(columns);
            *columns -= product(&self.globals, &overlap);
        }
    }

    /// Returns the number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.globals.nrows()
    }
}

/// Computes the exact Jacobian of every segment at a point.
pub(crate) fn jacobians(
    data: &Data,
    hypothesis: &Hypothesis,
    point: &Point,
) -> Result<Vec<DMatrix<f64>>, DynamicsError> {
    let mut simulator = Simulator::new(data, hypothesis, &point.globals, Derivatives::All)?;
    simulator.set(&point.globals)?;
    data.segments
        .iter()
        .zip(&point.starts)
        .map(|(segment, start)| Ok(simulator.predict(segment, start)?.jacobian))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::Projection;
    use nalgebra::DMatrix;

    /// Against a dense least-squares projection with one block of start columns per segment.
    #[test]
    fn the_arrow_projects_as_the_dense_matrix_does() {
        let entry = |i: usize, j: usize| ((i * 37 + j * 101) as f64 * 0.618).sin();
        let jacobians: Vec<DMatrix<f64>> =
            (0..3).map(|s| DMatrix::from_fn(12, 5, |i, j| entry(i + 12 * s, j))).collect();
        let projection = Projection::from_jacobians(&jacobians, 2);
        let mut columns = DMatrix::from_fn(36, 2, |i, j| entry(i, j + 9));
        let original = columns.clone();
        projection.apply(&mut columns);
        let dense = DMatrix::from_fn(36, 9, |i, j| match j {
            0..6 if j / 2 == i / 12 => jacobians[i / 12][(i % 12, j % 2)],
            0..6 => 0.0,
            _ => jacobians[i / 12][(i % 12, j - 4)],
        });
        let solution = dense.clone().svd(true, true).solve(&original, 1e-12).unwrap();
        let expected = original - dense * solution;
        assert!((columns - expected).norm() < 1e-10);
    }
}
