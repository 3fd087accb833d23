//! Complex numbers, for derivatives by the complex step in tests.
//!
//! Im f(x + ih)/h is f′(x) to rounding for a tiny h, without taking a difference (Squire, Trapp, SIAM Review 40
//! (1998) 110).

use super::Scalar;
use num_complex::Complex64;

impl Scalar for Complex64 {
    fn sin(self) -> Self {
        Self::sin(self)
    }

    fn cos(self) -> Self {
        Self::cos(self)
    }

    fn exp(self) -> Self {
        Self::exp(self)
    }
}
