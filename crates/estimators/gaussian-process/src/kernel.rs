//! Covariance functions.
//!
//! Reference: Rasmussen, Williams, Gaussian Processes for Machine Learning (2006), equations 4.9 and 4.17.

use serde::Deserialize;

/// Correlation k(ρ) of two function values at a distance of ρ length scales, ρ ≥ 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Kernel {
    /// Squared exponential, k = exp(−ρ²/2): infinitely smooth.
    #[serde(rename = "rbf")]
    Rbf,
    /// Matérn 3/2, k = (1 + √3·ρ)·exp(−√3·ρ): differentiable once.
    #[serde(rename = "matern-3/2")]
    MaternThreeHalves,
    /// Matérn 5/2, k = (1 + √5·ρ + 5ρ²/3)·exp(−√5·ρ): differentiable twice.
    #[serde(rename = "matern-5/2")]
    MaternFiveHalves,
}

impl Kernel {
    /// Returns k(ρ) and its first and second derivative with respect to the logarithm of the length scale,
    /// with D = −ρ·d/dρ:
    ///
    /// - RBF: Dk = ρ²·E and D²k = (ρ⁴ − 2ρ²)·E with E = exp(−ρ²/2);
    /// - Matérn 3/2: Dk = 3ρ²·E and D²k = (3√3·ρ³ − 6ρ²)·E with E = exp(−√3·ρ);
    /// - Matérn 5/2: Dk = (5/3)·ρ²·(1 + √5·ρ)·E and D²k = (5/3)·(5ρ⁴ − 2√5·ρ³ − 2ρ²)·E with E = exp(−√5·ρ).
    #[must_use]
    pub fn correlation(self, distance: f64) -> [f64; 3] {
        let square = distance * distance;
        match self {
            Self::Rbf => {
                let decay = (-0.5 * square).exp();
                [decay, square * decay, square * (square - 2.0) * decay]
            }
            Self::MaternThreeHalves => {
                let scaled = 3.0_f64.sqrt() * distance;
                let decay = (-scaled).exp();
                [(1.0 + scaled) * decay, 3.0 * square * decay, 3.0 * square * (scaled - 2.0) * decay]
            }
            Self::MaternFiveHalves => {
                let scaled = 5.0_f64.sqrt() * distance;
                let decay = 5.0 / 3.0 * square * (-scaled).exp();
                [
                    (1.0 + scaled + 5.0 / 3.0 * square) * (-scaled).exp(),
                    (1.0 + scaled) * decay,
                    (scaled * scaled - 2.0 * scaled - 2.0) * decay,
                ]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Kernel;

    const ALL: [Kernel; 3] = [Kernel::Rbf, Kernel::MaternThreeHalves, Kernel::MaternFiveHalves];

    #[test]
    fn they_are_the_formulas_of_the_book() {
        // The general Matérn function of Rasmussen, Williams (2006), equation 4.16, for p = 1 and p = 2.
        let matern = |p: u32, distance: f64| {
            let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
            let root = (2.0 * (f64::from(p) + 0.5)).sqrt();
            let sum: f64 = (0..=p)
                .map(|i| {
                    factorial(p + i) / (factorial(i) * factorial(p - i))
                        * (2.0 * root * distance).powi((p - i).try_into().unwrap())
                })
                .sum();
            (-root * distance).exp() * factorial(p) / factorial(2 * p) * sum
        };
        for distance in [0.0, 0.1, 1.0, 4.0] {
            let [rbf, three, five] = ALL.map(|kernel| kernel.correlation(distance)[0]);
            assert!((rbf - (-distance * distance / 2.0).exp()).abs() < 1e-15);
            assert!((three - matern(1, distance)).abs() < 1e-15, "{distance}");
            assert!((five - matern(2, distance)).abs() < 1e-15, "{distance}");
        }
    }

    #[test]
    fn the_derivatives_are_those_of_the_functions() {
        for kernel in ALL {
            for distance in [0.0, 0.1, 1.0, 4.0] {
                let at = |log_length: f64| kernel.correlation(distance / log_length.exp());
                for order in 0..2 {
                    let slope = (at(1e-5)[order] - at(-1e-5)[order]) / 2e-5;
                    assert!((slope - at(0.0)[order + 1]).abs() < 1e-9, "{kernel:?} {distance}");
                }
            }
        }
    }
}
