//! Linear least squares, implemented independently of the oracle.

use nalgebra::{DMatrix, DVector, SVD};

/// Smallest singular value that is used, as a share of the largest; weaker directions get no coefficient.
const WEAKEST: f64 = 1e-10;

/// Returns the shortest least-squares solution of `matrix`·c = `target`, with the columns scaled to length 1:
/// QR, then the singular values of R. Terms that cannot be told apart share what they explain.
///
/// `matrix` is n × k with n ≥ k, and `target` has length n. `None` if an entry is not finite, a column is
/// zero, or n < k.
pub fn solve(mut matrix: DMatrix<f64>, mut target: DVector<f64>) -> Option<DVector<f64>> {
    let lengths: Vec<f64> = matrix.column_iter().map(|column| column.norm()).collect();
    let usable = lengths.iter().all(|length| length.is_finite() && *length > 0.0);
    // The decompositions would not terminate on numbers that are not finite.
    if !usable || target.iter().any(|entry| !entry.is_finite()) || matrix.nrows() < matrix.ncols() {
        return None;
    }
    for (mut column, length) in matrix.column_iter_mut().zip(&lengths) {
        column /= *length;
    }
    let columns = matrix.ncols();
    let factors = matrix.qr();
    factors.q_tr_mul(&mut target);
    let singular = SVD::new(factors.r(), true, true);
    let tolerance = WEAKEST * singular.singular_values.max();
    let mut solution = singular.solve(&target.rows(0, columns).into_owned(), tolerance).ok()?;
    for (entry, length) in solution.iter_mut().zip(&lengths) {
        *entry /= length;
    }
    solution.iter().all(|entry| entry.is_finite()).then_some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residuals_are_orthogonal_to_every_column() {
        let matrix = DMatrix::from_fn(9, 3, |row, column| (row as f64 + 1.0).powi(column as i32 * 2));
        let target = DVector::from_fn(9, |row, _| ((row * 7 % 5) as f64).sin());
        let solution = solve(matrix.clone(), target.clone()).unwrap();
        let residual = target - &matrix * solution;
        for column in matrix.column_iter() {
            assert!(column.dot(&residual).abs() < 1e-13 * column.norm());
        }
    }

    #[test]
    fn equal_columns_share() {
        let matrix = DMatrix::from_fn(4, 2, |row, _| row as f64 + 1.0);
        let solution = solve(matrix.clone(), matrix.column(0) * 3.0).unwrap();
        assert!(solution.iter().all(|entry| (entry - 1.5).abs() < 1e-12), "{solution}");
    }

    #[test]
    fn what_is_not_finite_is_refused() {
        let ones = DMatrix::from_element(3, 1, 1.0);
        assert!(solve(ones.clone() * f64::NAN, DVector::zeros(3)).is_none());
        assert!(solve(ones.clone() * f64::MAX, DVector::zeros(3)).is_none());
        assert!(solve(ones.clone(), DVector::from_element(3, f64::INFINITY)).is_none());
        assert!(solve(ones * 0.0, DVector::zeros(3)).is_none());
    }
}
