//! Method 1: the textbook's closed form with means.

use super::linear::{LinearSolution, Solved, Stability, finish, line_from, scale, singular};
use super::vectors::{dot, length, sum};
use super::{ClassicalFit, ClassicalRoute};
use crate::error::OracleError;
use envelope::Envelope;
use seed::Seed;

/// Closed-form simple linear regression.
pub const ROUTE: ClassicalRoute = ClassicalRoute {
    id: "ols",
    paper_number: 1,
    title: "Linear regression (OLS)",
    summary: "Slope = covariance of t and ln A over variance of t, both about the means.",
    citations: &[
        "Draper, Smith, Applied Regression Analysis (3rd ed., Wiley 1998), section 1.2",
        "Chan, Golub, LeVeque, The American Statistician 37 (1983) 242",
    ],
    draws: false,
    fit,
};

fn fit(envelope: &Envelope, _: &Seed) -> Result<ClassicalFit, OracleError> {
    line_from(envelope, &line(envelope.times_s(), envelope.log_amplitudes())?)
}

/// Fits the line y = a + b·x with b = Σ(x − x̄)(y − ȳ)/Σ(x − x̄)² and a = ȳ − b·x̄; coefficients in the order
/// a, b.
///
/// The sums are taken about the means in a second pass, as in `scipy.stats.linregress`: the one-pass formula
/// n·Σxy − Σx·Σy loses digits to cancellation.
///
/// # Errors
/// [`OracleError`] for unusable input, or if fewer than four digits can be promised.
pub fn line(x: &[f64], y: &[f64]) -> Result<LinearSolution, OracleError> {
    let ones = vec![1.0; y.len()];
    let columns = [ones.as_slice(), x];
    let lengths = scale(&columns, y)?.lengths;
    let count = y.len() as f64;
    let (mean_x, mean_y) = (mean(x), mean(y));
    let centered_x: Vec<f64> = x.iter().map(|x| x - mean_x).collect();
    let centered_y: Vec<f64> = y.iter().map(|y| y - mean_y).collect();
    let spread = length(&centered_x);
    if spread == 0.0 {
        return Err(singular());
    }
    let slope = dot(&centered_x, &centered_y) / spread / spread;
    let constant = slope.mul_add(-mean_x, mean_y);

    // Cosine and sine of the angle between the constant and x.
    let size = length(x);
    let (cosine, sine) = (mean_x * count.sqrt() / size, spread / size);
    // For unit columns at that angle, (AᵀA)⁻¹ = M·Mᵀ with M = [[1, −cot], [0, 1/sin]].
    let inverse_rows = vec![vec![1.0, -cosine / sine], vec![0.0, 1.0 / sine]];
    // κ² = (1 + |cos|)/(1 − |cos|) = ((1 + |cos|)/sin)².
    let condition = (1.0 + cosine.abs()) / sine;
    let scaled = [constant, slope].iter().zip(&lengths).map(|(x, length)| x * length).collect();
    let solved =
        Solved { lengths: &lengths, scaled, inverse_rows, condition, stability: Stability::Orthogonal };
    finish(&columns, y, solved)
}

/// Returns the mean; a second pass removes the rounding error of the first.
fn mean(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let first = sum(values) / count;
    let rest: Vec<f64> = values.iter().map(|value| value - first).collect();
    first + sum(&rest) / count
}

#[cfg(test)]
mod tests {
    use super::line;

    #[test]
    fn three_points_by_hand() {
        // x̄ = 1, ȳ = 2, Sxy = 3, Sxx = 2; residuals 1/2, −1, 1/2.
        let fit = line(&[0.0, 1.0, 2.0], &[1.0, 1.0, 4.0]).unwrap();
        assert!((fit.coefficients[0] - 0.5).abs() < 1e-15 && (fit.coefficients[1] - 1.5).abs() < 1e-15);
        assert!((fit.residual_std_dev - 1.5_f64.sqrt()).abs() < 1e-15);
        assert!((fit.std_errors[1] - 0.75_f64.sqrt()).abs() < 1e-15);
        // (AᵀA)⁻¹ = [[5, −3], [−3, 3]]/6: error of the constant √(1.5·5/6).
        assert!((fit.std_errors[0] - 1.25_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn a_single_abscissa_gives_no_line() {
        let message = line(&[2.0; 4], &[1.0, 2.0, 3.0, 4.0]).unwrap_err().to_string();
        assert!(message.contains("condition number inf"), "{message}");
    }
}
