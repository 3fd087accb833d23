//! Method 3: the normal equations, by Cholesky's factorization.

use super::linear::{LinearSolution, Solved, Stability, Triangle, finish, fit_line, scale, singular};
use super::vectors::{UNIT_ROUNDOFF, dot, rows};
use super::{ClassicalFit, ClassicalRoute};
use crate::error::OracleError;
use envelope::Envelope;
use seed::Seed;

/// Least squares by the normal equations.
pub const ROUTE: ClassicalRoute = ClassicalRoute {
    id: "normal-equations",
    paper_number: 3,
    title: "Normal equations",
    summary: "Solves AᵀA·x = Aᵀy, which squares the condition number.",
    citations: &["Björck, Numerical Methods for Least Squares Problems (SIAM 1996), section 2.2"],
    draws: false,
    fit,
};

fn fit(envelope: &Envelope, _: &Seed) -> Result<ClassicalFit, OracleError> {
    fit_line(envelope, least_squares)
}

/// Fits `y` by least squares on the columns of a design matrix, each as long as `y`, by AᵀA = RᵀR.
///
/// Columns are scaled to length one first, which nearly minimizes the condition number (van der Sluis 1969).
/// The matrix is factorized and never inverted, although the paper's formula is (AᵀA)⁻¹Aᵀb.
///
/// # Errors
/// [`OracleError`] for unusable input, or if fewer than four digits can be promised: at condition numbers
/// above about 10⁵.
pub fn least_squares(columns: &[&[f64]], y: &[f64]) -> Result<LinearSolution, OracleError> {
    let scaled = scale(columns, y)?;
    let triangle = cholesky(&scaled.columns)?;
    let right: Vec<f64> = scaled.columns.iter().map(|column| dot(column, y)).collect();
    let solved = Solved {
        lengths: &scaled.lengths,
        scaled: triangle.solve(&triangle.solve_transposed(&right)),
        inverse_rows: triangle.inverse_rows(),
        condition: triangle.condition(),
        stability: Stability::NormalEquations,
    };
    finish(columns, y, solved)
}

/// Returns R with RᵀR = AᵀA for unit columns. A pivot that is nothing but rounding is refused.
fn cholesky(columns: &[Vec<f64>]) -> Result<Triangle, OracleError> {
    let mut triangle = Triangle(Vec::new());
    let noise = columns.len() as f64 * (rows(columns) as f64).sqrt() * UNIT_ROUNDOFF;
    for (count, column) in columns.iter().enumerate() {
        let products: Vec<f64> = columns.iter().take(count).map(|earlier| dot(earlier, column)).collect();
        let mut entries = triangle.solve_transposed(&products);
        let pivot = dot(column, column) - dot(&entries, &entries);
        if pivot.is_nan() || pivot <= noise {
            return Err(singular());
        }
        entries.push(pivot.sqrt());
        triangle.0.push(entries);
    }
    Ok(triangle)
}

#[cfg(test)]
mod tests {
    use super::least_squares;

    #[test]
    fn three_columns_by_hand() {
        // The parabola through 1, 0, 1 at −1, 0, 1 and 4 at ±2 is x².
        let x = [-2.0_f64, -1.0, 0.0, 1.0, 2.0];
        let square = x.map(|x| x * x);
        let fit = least_squares(&[&[1.0; 5], &x, &square], &[4.0, 1.0, 0.0, 1.0, 4.0]).unwrap();
        for (found, expected) in fit.coefficients.iter().zip([0.0, 0.0, 1.0]) {
            assert!((found - expected).abs() < 1e-14, "{fit:?}");
        }
    }
}
