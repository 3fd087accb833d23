//! Numbers on which a force law can be evaluated.
//!
//! A law is written once, over any [`Scalar`]: doubles yield the force, [`Dual`] numbers its exact
//! derivatives, and expressions (inside [`crate::sensitivity`]) its Taylor series. There is no second,
//! hand-written derivative that could disagree with the law.

#[cfg(test)]
mod complex;
mod dual;
mod rounded;

pub use dual::Dual;
pub(crate) use rounded::Rounded;

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Commutative field with the elementary functions that force laws use.
pub trait Scalar:
    Copy
    + From<f64>
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// Returns the sine of an angle in radians.
    #[must_use]
    fn sin(self) -> Self;

    /// Returns the cosine of an angle in radians.
    #[must_use]
    fn cos(self) -> Self;

    /// Returns the exponential.
    #[must_use]
    fn exp(self) -> Self;
}

impl Scalar for f64 {
    fn sin(self) -> Self {
        libm::sin(self)
    }

    fn cos(self) -> Self {
        libm::cos(self)
    }

    fn exp(self) -> Self {
        libm::exp(self)
    }
}
