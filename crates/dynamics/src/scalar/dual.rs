//! Forward-mode automatic differentiation.

use super::Scalar;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Value with its partial derivatives with respect to `N` variables.
///
/// ```
/// use dynamics::scalar::{Dual, Scalar};
///
/// let angle = Dual::<1>::variable(0.5, 0);
/// let torque = angle.sin() * Dual::from(3.0);
/// assert_eq!(torque.partials, [3.0 * 0.5_f64.cos()]);
/// ```
///
/// # Reference
/// Griewank, Walther, Evaluating Derivatives, 2nd ed., SIAM 2008, section 3.1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<const N: usize> {
    /// Value.
    pub value: f64,
    /// Partial derivatives.
    pub partials: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// Creates the variable with number `index` (from 0) at a value; a constant if `index` is `N` or more.
    #[must_use]
    pub fn variable(value: f64, index: usize) -> Self {
        let mut partials = [0.0; N];
        if let Some(partial) = partials.get_mut(index) {
            *partial = 1.0;
        }
        Self { value, partials }
    }

    /// Applies the chain rule, given a function's value and its derivative at `self.value`.
    fn chain(self, value: f64, derivative: f64) -> Self {
        Self { value, partials: self.partials.map(|partial| partial * derivative) }
    }

    /// Returns a value with the partial derivatives `own`·∂self + `others`·∂other.
    fn combine(self, other: Self, value: f64, own: f64, others: f64) -> Self {
        let mut partials = self.partials;
        for (partial, &second) in partials.iter_mut().zip(&other.partials) {
            *partial = own * *partial + others * second;
        }
        Self { value, partials }
    }
}

impl<const N: usize> From<f64> for Dual<N> {
    fn from(value: f64) -> Self {
        Self { value, partials: [0.0; N] }
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;

    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.combine(other, self.value + other.value, 1.0, 1.0)
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.combine(other, self.value - other.value, 1.0, -1.0)
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        self.combine(other, self.value * other.value, other.value, self.value)
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        self.combine(other, quotient, 1.0 / other.value, -quotient / other.value)
    }
}

impl<const N: usize> Add<f64> for Dual<N> {
    type Output = Self;

    fn add(self, other: f64) -> Self {
        self.chain(self.value + other, 1.0)
    }
}

impl<const N: usize> Sub<f64> for Dual<N> {
    type Output = Self;

    fn sub(self, other: f64) -> Self {
        self.chain(self.value - other, 1.0)
    }
}

impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;

    fn mul(self, other: f64) -> Self {
        self.chain(self.value * other, other)
    }
}

impl<const N: usize> Scalar for Dual<N> {
    fn sin(self) -> Self {
        self.chain(libm::sin(self.value), libm::cos(self.value))
    }

    fn cos(self) -> Self {
        self.chain(libm::cos(self.value), -libm::sin(self.value))
    }

    fn exp(self) -> Self {
        let value = libm::exp(self.value);
        self.chain(value, value)
    }
}
