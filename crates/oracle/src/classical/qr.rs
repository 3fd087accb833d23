//! Method 4: QR decomposition by Householder reflections.

use super::linear::{LinearSolution, Solved, Stability, Triangle, finish, fit_line, scale, singular};
use super::vectors::{add_scaled, dot, length};
use super::{ClassicalFit, ClassicalRoute};
use crate::error::OracleError;
use envelope::Envelope;
use seed::Seed;

/// Least squares by Householder QR.
pub const ROUTE: ClassicalRoute = ClassicalRoute {
    id: "qr",
    paper_number: 4,
    title: "QR decomposition",
    summary: "Householder reflections turn the design matrix into a triangle, which is solved.",
    citations: &["Householder, J. ACM 5 (1958) 339", "Golub, Numerische Mathematik 7 (1965) 206"],
    draws: false,
    fit,
};

fn fit(envelope: &Envelope, _: &Seed) -> Result<ClassicalFit, OracleError> {
    fit_line(envelope, least_squares)
}

/// Fits `y` by least squares on the columns of a design matrix, each as long as `y`, by R·x = Qᵀy.
///
/// # Errors
/// [`OracleError`] for unusable input, or if fewer than four digits can be promised.
pub fn least_squares(columns: &[&[f64]], y: &[f64]) -> Result<LinearSolution, OracleError> {
    let scaled = scale(columns, y)?;
    let factor = factorize(scaled.columns, y.to_vec());
    if factor.triangle.is_singular() {
        return Err(singular());
    }
    let solved = Solved {
        lengths: &scaled.lengths,
        scaled: factor.triangle.solve(&factor.projected),
        inverse_rows: factor.triangle.inverse_rows(),
        condition: factor.triangle.condition(),
        stability: Stability::Orthogonal,
    };
    finish(columns, y, solved)
}

/// Factors A = Q·R, with the right-hand side in the basis of Q.
pub(super) struct Factor {
    pub(super) triangle: Triangle,
    /// Part of Qᵀy in the columns' span.
    pub(super) projected: Vec<f64>,
    /// Rest of Qᵀy: as long as the residuals of the least-squares solution.
    pub(super) rest: Vec<f64>,
}

/// Reflects the columns one after the other onto the axes. Each column is at least as long as the number of
/// columns.
pub(super) fn factorize(mut columns: Vec<Vec<f64>>, mut y: Vec<f64>) -> Factor {
    for step in 0..columns.len() {
        let (done, active) = columns.split_at_mut(step + 1);
        let Some(pivot) = done.last_mut() else { break };
        let mut normal: Vec<f64> = pivot.iter().skip(step).copied().collect();
        let size = length(&normal);
        let Some(head) = normal.first_mut() else { break };
        // The sign is chosen so that the head grows and does not cancel.
        let image = -size.copysign(*head);
        *head -= image;
        let square = dot(&normal, &normal);
        if square > 0.0 {
            for target in active.iter_mut().chain(std::iter::once(&mut y)) {
                if let Some(part) = target.get_mut(step..) {
                    let share = 2.0 * dot(&normal, part) / square;
                    add_scaled(part, -share, &normal);
                }
            }
        }
        pivot.truncate(step);
        pivot.push(image);
    }
    let rest = y.split_off(columns.len().min(y.len()));
    Factor { triangle: Triangle(columns), projected: y, rest }
}

#[cfg(test)]
mod tests {
    use super::{factorize, least_squares};
    use crate::classical::vectors::{dot, length};

    #[test]
    fn the_triangle_has_the_matrix_s_inner_products() {
        let columns = vec![vec![1.0, 2.0, -1.0, 0.5], vec![0.0, 3.0, 1.0, -2.0], vec![1.0, 1.0, 1.0, 1.0]];
        let y = vec![1.0, -2.0, 0.25, 3.0];
        let factor = factorize(columns.clone(), y.clone());
        let square = factor.triangle.square();
        for (a, r) in columns.iter().zip(&square) {
            for (b, s) in columns.iter().zip(&square) {
                assert!((dot(a, b) - dot(r, s)).abs() < 1e-14);
            }
            assert!((dot(a, &y) - dot(r, &factor.projected)).abs() < 1e-14);
        }
        assert!((dot(&y, &y).sqrt() - length(&factor.projected).hypot(length(&factor.rest))).abs() < 1e-14);
    }

    #[test]
    fn equal_columns_are_refused() {
        let column = [1.0, 2.0, 3.0, 4.0];
        let error = least_squares(&[&column, &column], &[1.0, 0.0, 2.0, 5.0]).unwrap_err();
        assert!(error.to_string().contains("at least 4 are needed"), "{error}");
    }
}
