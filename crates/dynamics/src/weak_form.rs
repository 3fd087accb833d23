//! Test functions of the weak form.
//!
//! An equation of motion is multiplied by a smooth function that vanishes at both ends of a window, and
//! integrated by parts until only that function is differentiated and no reading:
//! ∫φ·θ̈ dt = ∫φ̈·θ dt, ∫φ·θ̇ dt = −∫φ̇·θ dt.
//!
//! # Reference
//! M. Shinbrot, On the analysis of linear and nonlinear systems, Trans. ASME 79 (1957) 547; D. A. Messenger,
//! D. M. Bortz, Multiscale Modeling and Simulation 19 (2021) 1474.

/// Computes the test function φ = (1 − s²)ⁿ and its first and second derivative with respect to s; all are 0
/// outside of −1 to 1.
///
/// `exponent` is n, at least 2. In a window of half width h about t₀, s is (t − t₀)/h, φ̇ is the second
/// number over h, and φ̈ the third over h².
///
/// # Example
/// At the center, the function with exponent n is 1, its slope is 0, and its second derivative is −2n:
///
/// ```
/// assert_eq!(dynamics::weak_form::test_function(0.0, 4), [1.0, 0.0, -8.0]);
/// ```
#[must_use]
pub fn test_function(s: f64, exponent: i32) -> [f64; 3] {
    let (n, base) = (f64::from(exponent), 1.0 - s * s);
    if base <= 0.0 {
        return [0.0; 3];
    }
    let (low, middle) = (base.powi(exponent - 2), base.powi(exponent - 1));
    [base.powi(exponent), -2.0 * n * s * middle, -2.0 * n * middle + 4.0 * n * (n - 1.0) * s * s * low]
}

#[cfg(test)]
mod tests {
    use super::test_function;

    #[test]
    fn a_test_function_has_the_derivatives_it_states() {
        for exponent in [2, 4, 6] {
            for s in [-0.9, -0.3, 0.0, 0.5, 0.99] {
                let at = |s: f64| test_function(s, exponent);
                let slope = (at(s + 1e-6)[0] - at(s - 1e-6)[0]) / 2e-6;
                let curvature = (at(s + 1e-6)[1] - at(s - 1e-6)[1]) / 2e-6;
                assert!((at(s)[1] - slope).abs() < 1e-7 && (at(s)[2] - curvature).abs() < 1e-7, "{s}");
            }
            assert_eq!(test_function(1.5, exponent), [0.0; 3]);
        }
    }
}
