//! Running error analysis: a value with a bound for its rounding error.

use super::Scalar;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Double with a bound, to first order, for its own rounding error. Numbers that enter are known to one unit
/// in 2⁵² of their size, and every operation adds as much of its result. If large terms cancel, the bound
/// stays large. Regrouping sums and factors exceeds the bound by no more than a few times.
///
/// # Reference
/// Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., SIAM 2002, section 3.3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rounded {
    value: f64,
    pub(crate) error: f64,
}

impl Rounded {
    /// Creates the result of an operation, with the errors inherited from its operands.
    fn new(value: f64, along: f64) -> Self {
        Self { value, error: along + f64::EPSILON * value.abs() }
    }
}

impl From<f64> for Rounded {
    fn from(value: f64) -> Self {
        Self::new(value, 0.0)
    }
}

impl Neg for Rounded {
    type Output = Self;

    fn neg(self) -> Self {
        Self { value: -self.value, ..self }
    }
}

impl Add for Rounded {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.value + other.value, self.error + other.error)
    }
}

impl Sub for Rounded {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Rounded {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let along = self.value.abs() * other.error + other.value.abs() * self.error;
        Self::new(self.value * other.value, along)
    }
}

impl Div for Rounded {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self::new(value, (self.error + value.abs() * other.error) / other.value.abs())
    }
}

impl Add<f64> for Rounded {
    type Output = Self;

    fn add(self, other: f64) -> Self {
        self + Self::from(other)
    }
}

impl Sub<f64> for Rounded {
    type Output = Self;

    fn sub(self, other: f64) -> Self {
        self - Self::from(other)
    }
}

impl Mul<f64> for Rounded {
    type Output = Self;

    fn mul(self, other: f64) -> Self {
        self * Self::from(other)
    }
}

impl Scalar for Rounded {
    fn sin(self) -> Self {
        Self::new(libm::sin(self.value), libm::cos(self.value).abs() * self.error)
    }

    fn cos(self) -> Self {
        Self::new(libm::cos(self.value), libm::sin(self.value).abs() * self.error)
    }

    fn exp(self) -> Self {
        let value = libm::exp(self.value);
        Self::new(value, value * self.error)
    }
}

#[cfg(test)]
mod tests {
    use super::Rounded;
    use crate::scalar::Scalar;

    #[test]
    fn what_cancels_is_known_no_better_than_its_terms() {
        let [a, b, c] = [0.1, 0.2, 0.3].map(Rounded::from);
        let left = a + b - c;
        assert!(left.value != 0.0 && left.value.abs() < left.error, "{left:?}");
        assert!(left.error < 6.0 * f64::EPSILON * 0.3, "{left:?}");
        // π as a double is off by 1.2e-16.
        let half_turn = Rounded::from(std::f64::consts::PI);
        let sine = half_turn.sin();
        assert!(sine.value.abs() < sine.error && sine.error < 4.0 * f64::EPSILON * 3.2, "{sine:?}");
        let quotient = (a + b) * 1e9 / (a * 10.0) - c * 1e9;
        assert!(quotient.value.abs() < quotient.error && quotient.error < 1e-6, "{quotient:?}");
        let one = (a + b - c).exp() - 1.0;
        assert!(one.value.abs() < one.error, "{one:?}");
    }
}
