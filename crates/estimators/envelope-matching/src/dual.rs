//! Dual numbers, which carry their derivative.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Value with its derivative by λ; arithmetic on it differentiates exactly.
///
/// Reference: Griewank, Walther, Evaluating Derivatives (SIAM 2008), chapter 3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Dual {
    pub(crate) value: f64,
    pub(crate) slope: f64,
}

impl Dual {
    pub(crate) const fn constant(value: f64) -> Self {
        Self { value, slope: 0.0 }
    }

    /// Creates the variable that derivatives are taken by.
    pub(crate) const fn variable(value: f64) -> Self {
        Self { value, slope: 1.0 }
    }

    pub(crate) fn ln(self) -> Self {
        Self { value: self.value.ln(), slope: self.slope / self.value }
    }

    pub(crate) fn is_finite(self) -> bool {
        self.value.is_finite() && self.slope.is_finite()
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { value: self.value * other.value, slope: self.slope * other.value + self.value * other.slope }
    }
}

impl Mul<f64> for Dual {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { value: self.value * factor, slope: self.slope * factor }
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: (self.slope - value * other.slope) / other.value }
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}
