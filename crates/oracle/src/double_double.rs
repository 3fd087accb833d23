//! Numbers of twice a double's precision: unevaluated sums of two doubles.
//!
//! They have about 31 decimal digits (unit roundoff 2⁻¹⁰⁴ after a few operations). The algorithms are the
//! error-free sum of Dekker and Knuth, and their product with a fused multiply-add.
//!
//! Reference: Dekker, Numerische Mathematik 18 (1971) 224; Hida, Li, Bailey, ARITH-15 (2001) 155.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Unevaluated sum `high + low` with |low| at most half a unit in the last place of `high`.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default)]
pub(crate) struct DoubleDouble {
    high: f64,
    low: f64,
}

/// Unit roundoff that the error estimates assume.
pub(crate) const UNIT_ROUNDOFF: f64 = 4.93e-32; // 2^-104

impl DoubleDouble {
    pub(crate) const ZERO: Self = Self { high: 0.0, low: 0.0 };

    /// Returns the nearest double.
    pub(crate) fn value(self) -> f64 {
        self.high
    }

    pub(crate) fn is_zero(self) -> bool {
        self.high == 0.0
    }

    /// Returns the square root by one step of Newton's method; 0 for numbers that are not positive.
    pub(crate) fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::ZERO;
        }
        let guess = self.high.sqrt();
        let rest = self - Self::from(guess) * Self::from(guess);
        Self::from(guess) + Self::from(rest.high / (2.0 * guess))
    }

    /// Returns `a + b` exactly, for |a| ≥ |b|.
    fn renormalize(a: f64, b: f64) -> Self {
        let high = a + b;
        Self { high, low: b - (high - a) }
    }
}

/// Returns `a + b` exactly, as rounded sum and error.
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

/// Returns the inner product.
pub(crate) fn dot(a: &[DoubleDouble], b: &[DoubleDouble]) -> DoubleDouble {
    a.iter().zip(b).map(|(&a, &b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::{DoubleDouble, UNIT_ROUNDOFF, dot};
    use rand::RngExt;
    use seed::Seed;

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

    /// Whole numbers whose sums, differences and products fit into 106 bits are computed exactly.
    #[test]
    fn whole_numbers_are_computed_with_exactly() {
        let mut generator = Seed::new(3).generator();
        for _ in 0..2000 {
            // A number of up to 100 bits, in two parts that each fit into a double.
            let mut whole = |bits: u32| -> i128 {
                let high = i128::from(generator.random_range(-(1_i64 << 52)..=1 << 52));
                let low = i128::from(generator.random_range(-(1_i64 << 46)..=1 << 46));
                let shift = generator.random_range(0..=bits);
                if shift > 47 { (high << shift) + low } else { high + low }
            };
            let (a, b, c) = (whole(50), whole(50), whole(0));
            let (x, y, z) = (exact(a), exact(b), exact(c));
            assert_eq!([back(x), back(y), back(-x)], [a, b, -a]);
            assert_eq!([back(x + y), back(x - y), back(y - x)], [a + b, a - b, b - a], "{a} {b}");
            // 52 times 53 bits.
            let (d, e) = (c, i128::from(generator.random_range(1_i64..=1 << 52)));
            let product = z * exact(e);
            assert_eq!(back(product), d * e, "{d} {e}");
            assert_eq!(back(product / exact(e)), d, "{d} {e}");
            assert_eq!(back((exact(e) * exact(e)).sqrt()), e);
            assert_eq!(back([x, y, -x].into_iter().sum()), b);
            assert_eq!(back(dot(&[z, z], &[exact(1), exact(1)])), 2 * c);
        }
    }

    /// Products, quotients and roots of numbers in two parts are accurate to 104 bits.
    #[test]
    fn long_products_quotients_and_roots_are_good_to_thirty_digits() {
        let mut generator = Seed::new(4).generator();
        let mut long = || {
            let (high, low): (f64, f64) =
                (generator.random_range(0.5..1.0), generator.random_range(-1.0..1.0));
            DoubleDouble::renormalize(high, low * f64::EPSILON / 4.0)
        };
        for _ in 0..2000 {
            let (a, b, c) = (long(), long(), long());
            let off = |found: DoubleDouble, expected: DoubleDouble| (found - expected).value().abs();
            let near = 16.0 * UNIT_ROUNDOFF;
            assert!(off(a * b, b * a) <= near && off((a * b) * c, a * (b * c)) <= near);
            assert!(off(a * (b + c), a * b + a * c) <= near, "{a:?} {b:?} {c:?}");
            assert!(off((a / b) * b, a) <= near, "{a:?} {b:?}");
            assert!(off(a.sqrt() * a.sqrt(), a) <= near, "{a:?}");
        }
    }

    #[test]
    fn nothing_has_no_root_and_is_told_from_little() {
        assert!(DoubleDouble::ZERO.is_zero() && DoubleDouble::ZERO.sqrt().is_zero());
        assert!(DoubleDouble::from(-4.0).sqrt().is_zero());
        assert!(!DoubleDouble::from(f64::MIN_POSITIVE).is_zero());
    }

    fn exact(whole: i128) -> DoubleDouble {
        let high = whole as f64;
        DoubleDouble { high, low: (whole - high as i128) as f64 }
    }

    fn back(number: DoubleDouble) -> i128 {
        number.high as i128 + number.low as i128
    }
}
