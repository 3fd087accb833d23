//! Operators of expressions.
//!
//! None is "protected": outside of its domain an operator gives the result of double arithmetic, and the
//! expression is rejected for it.

use std::f64::consts::FRAC_PI_2;

/// Operator with one operand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unary {
    Exp,
    Log,
    SquareRoot,
    Square,
    Sine,
}

/// Operator with two operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
}

impl Unary {
    /// Operators that are drawn; the sine comes last, so that it can be left out.
    pub(crate) const ALL: [Self; 5] = [Self::Exp, Self::Log, Self::SquareRoot, Self::Square, Self::Sine];

    pub(crate) fn value(self, a: f64) -> f64 {
        match self {
            Self::Exp => a.exp(),
            Self::Log => a.ln(),
            Self::SquareRoot => a.sqrt(),
            Self::Square => a * a,
            Self::Sine => a.sin(),
        }
    }

    /// Appends the values for many operands; the operator is selected outside of the loop.
    pub(crate) fn apply(self, operands: &[f64], values: &mut Vec<f64>) {
        match self {
            Self::Exp => values.extend(operands.iter().map(|a| a.exp())),
            Self::Log => values.extend(operands.iter().map(|a| a.ln())),
            Self::SquareRoot => values.extend(operands.iter().map(|a| a.sqrt())),
            Self::Square => values.extend(operands.iter().map(|a| a * a)),
            Self::Sine => values.extend(operands.iter().map(|a| a.sin())),
        }
    }

    /// Returns the derivative at an operand whose value is known.
    pub(crate) fn slope(self, a: f64, value: f64) -> f64 {
        match self {
            Self::Exp => value,
            Self::Log => 1.0 / a,
            Self::SquareRoot => 0.5 / value,
            Self::Square => 2.0 * a,
            Self::Sine => a.cos(),
        }
    }

    /// Returns the bounds of the value for an operand in a range; `None` if the range leaves the domain.
    pub(crate) fn range(self, [low, high]: [f64; 2]) -> Option<[f64; 2]> {
        match self {
            Self::Exp => Some([low.exp(), high.exp()]),
            Self::Log => (low > 0.0).then(|| [low.ln(), high.ln()]),
            Self::SquareRoot => (low >= 0.0).then(|| [low.sqrt(), high.sqrt()]),
            Self::Square => {
                let (one, other) = (low * low, high * high);
                let least = if low <= 0.0 && high >= 0.0 { 0.0 } else { one.min(other) };
                Some([least, one.max(other)])
            }
            Self::Sine if -FRAC_PI_2 <= low && high <= FRAC_PI_2 => Some([low.sin(), high.sin()]),
            Self::Sine => Some([-1.0, 1.0]),
        }
    }

    /// Returns the name used in equations.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Exp => "exp",
            Self::Log => "log",
            Self::SquareRoot => "sqrt",
            Self::Square => "square",
            Self::Sine => "sin",
        }
    }
}

impl Binary {
    pub(crate) const ALL: [Self; 4] = [Self::Add, Self::Subtract, Self::Multiply, Self::Divide];

    pub(crate) fn value(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
        }
    }

    /// Returns the derivative by the left operand.
    pub(crate) fn left_slope(self, b: f64) -> f64 {
        match self {
            Self::Add | Self::Subtract => 1.0,
            Self::Multiply => b,
            Self::Divide => 1.0 / b,
        }
    }

    /// Returns the derivative by the right operand.
    pub(crate) fn right_slope(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => 1.0,
            Self::Subtract => -1.0,
            Self::Multiply => a,
            Self::Divide => -a / (b * b),
        }
    }

    /// Returns the bounds of the value for operands in ranges; `None` if the ranges leave the domain.
    pub(crate) fn range(self, [a, b]: [f64; 2], [c, d]: [f64; 2]) -> Option<[f64; 2]> {
        let corners = |at: [f64; 4]| {
            Some([
                at.into_iter().fold(f64::INFINITY, f64::min),
                at.into_iter().fold(-f64::INFINITY, f64::max),
            ])
        };
        match self {
            Self::Add => Some([a + c, b + d]),
            Self::Subtract => Some([a - d, b - c]),
            Self::Multiply => corners([a * c, a * d, b * c, b * d]),
            Self::Divide if c <= 0.0 && d >= 0.0 => None,
            Self::Divide => corners([a / c, a / d, b / c, b / d]),
        }
    }
}
