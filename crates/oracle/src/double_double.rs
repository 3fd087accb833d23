//! Numbers of twice the double's precision: an unevaluated sum of two doubles.
//!
//! About 31 decimal digits (unit roundoff 2⁻¹⁰⁴ after a few operations). The algorithms are Dekker's
//! and Knuth's error-free sum and, with a fused multiply-add, product.
//!
//! Reference: Dekker, Numerische Mathematik 18 (1971) 224; Hida, Li, Bailey, ARITH-15 (2001) 155.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// An unevaluated sum `high + low` with |low| at most half a unit in the last place of `high`.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default)]
pub(crate) struct DoubleDouble {
    high: f64,
    low: f64,
}

/// Unit roundoff that the error estimates assume.
pub(crate) const UNIT_ROUNDOFF: f64 = 4.93e-32; // 2^-104

impl DoubleDouble {
    pub(crate) const ZERO: Self = Self { high: 0.0, low: 0.0 };

    /// The nearest double.
    pub(crate) fn value(self) -> f64 {
        self.high
    }

    pub(crate) fn is_zero(self) -> bool {
        self.high == 0.0
    }

    /// Square root by one step of Newton's method; 0 for what is not positive.
    pub(crate) fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::ZERO;
        }
        let guess = self.high.sqrt();
        let rest = self - Self::from(guess) * Self::from(guess);
        Self::from(guess) + Self::from(rest.high / (2.0 * guess))
    }

    /// `a + b` where |a| ≥ |b|, exactly.
    fn renormalize(a: f64, b: f64) -> Self {
        let high = a + b;
        Self { high, low: b - (high - a) }
    }
}

/// `a + b`, exactly.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

impl From<f64> for DoubleDouble {
    fn from(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, error) = two_sum(self.high, other.high);
        let (low, low_error) = two_sum(self.low, other.low);
        let first = Self::renormalize(high, error + low);
        Self::renormalize(first.high, first.low + low_error)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = self.high * other.high;
        let error = self.high.mul_add(other.high, -product);
        Self::renormalize(product, error + (self.high * other.low + self.low * other.high))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        let third = rest.high / other.high;
        Self::renormalize(first, second) + Self::from(third)
    }
}

impl std::iter::Sum for DoubleDouble {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::ZERO, |sum, term| sum + term)
    }
}

/// Inner product.
pub(crate) fn dot(a: &[DoubleDouble], b: &[DoubleDouble]) -> DoubleDouble {
    a.iter().zip(b).map(|(&a, &b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::{DoubleDouble, UNIT_ROUNDOFF};

    #[test]
    fn a_third_three_times_is_one() {
        let third = DoubleDouble::from(1.0) / DoubleDouble::from(3.0);
        let error = (third + third + third - DoubleDouble::from(1.0)).value();
        assert!(error.abs() < 2.0 * UNIT_ROUNDOFF, "{error:e}");
    }

    #[test]
    fn the_root_of_two_squared_is_two() {
        let root = DoubleDouble::from(2.0).sqrt();
        let error = (root * root - DoubleDouble::from(2.0)).value();
        assert!(error.abs() < 4.0 * UNIT_ROUNDOFF, "{error:e}");
    }

    #[test]
    fn what_a_double_loses_is_kept() {
        let sum = DoubleDouble::from(1e16) + DoubleDouble::from(1.0) - DoubleDouble::from(1e16);
        assert_eq!(sum.value(), 1.0);
    }
}
