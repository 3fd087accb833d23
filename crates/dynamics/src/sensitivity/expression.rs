//! Force laws recorded as expressions.

use crate::scalar::Scalar;
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// One operation; operands are numbers of earlier nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Operation {
    /// Quantity set from outside.
    Leaf(usize),
    Add(usize, usize),
    Subtract(usize, usize),
    Multiply(usize, usize),
    Divide(usize, usize),
    /// Times a number.
    Scale(usize, f64),
    /// Plus a number.
    Offset(usize, f64),
    /// The node after a sine is always the cosine of the same operand.
    Sine(usize),
    /// The node before a cosine is always the sine of the same operand.
    Cosine(usize),
    Exponential(usize),
}

/// Recorder of operations on expressions; the same operation on the same operands is recorded once.
#[derive(Debug, Default)]
pub(crate) struct Recorder {
    operations: RefCell<Vec<Operation>>,
}

impl Recorder {
    pub(crate) fn leaf(&self, number: usize) -> Expression<'_> {
        self.node(Operation::Leaf(number))
    }

    pub(crate) fn into_operations(self) -> Vec<Operation> {
        self.operations.into_inner()
    }

    fn node(&self, operation: Operation) -> Expression<'_> {
        Expression::Node { recorder: self, number: self.push(operation) }
    }

    fn push(&self, operation: Operation) -> usize {
        let mut operations = self.operations.borrow_mut();
        operations.iter().position(|known| *known == operation).unwrap_or_else(|| {
            operations.push(operation);
            operations.len() - 1
        })
    }

    /// Records sine and cosine of a node, always as neighbors: each needs the other's series.
    fn circular(&self, operand: usize) -> (Expression<'_>, Expression<'_>) {
        (self.node(Operation::Sine(operand)), self.node(Operation::Cosine(operand)))
    }

    /// Returns the number of the node that represents an expression.
    pub(crate) fn number(&self, expression: Expression<'_>) -> usize {
        match expression {
            Expression::Node { number, .. } => number,
            // A constant needs a node only if it is a result: any leaf, times zero, plus the constant.
            Expression::Constant(value) => {
                let leaf = self.push(Operation::Leaf(0));
                let zero = self.push(Operation::Scale(leaf, 0.0));
                self.push(Operation::Offset(zero, value))
            }
        }
    }
}

/// Number that is not known yet; a law computes with it while it is recorded.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Expression<'r> {
    Constant(f64),
    Node { recorder: &'r Recorder, number: usize },
}

impl From<f64> for Expression<'_> {
    fn from(value: f64) -> Self {
        Self::Constant(value)
    }
}

impl<'r> Expression<'r> {
    fn scale(self, factor: f64) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(value * factor),
            Self::Node { .. } if factor == 0.0 => Self::Constant(0.0),
            Self::Node { .. } if factor == 1.0 => self,
            Self::Node { recorder, number } => recorder.node(Operation::Scale(number, factor)),
        }
    }

    fn offset(self, summand: f64) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(value + summand),
            Self::Node { .. } if summand == 0.0 => self,
            Self::Node { recorder, number } => recorder.node(Operation::Offset(number, summand)),
        }
    }
}

impl Neg for Expression<'_> {
    type Output = Self;

    fn neg(self) -> Self {
        self.scale(-1.0)
    }
}

impl Add for Expression<'_> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        match (self, other) {
            (Self::Constant(value), _) => other.offset(value),
            (_, Self::Constant(value)) => self.offset(value),
            (Self::Node { recorder, number }, Self::Node { number: second, .. }) => {
                recorder.node(Operation::Add(number, second))
            }
        }
    }
}

impl Sub for Expression<'_> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        match (self, other) {
            (Self::Constant(value), _) => other.scale(-1.0).offset(value),
            (_, Self::Constant(value)) => self.offset(-value),
            (Self::Node { recorder, number }, Self::Node { number: second, .. }) => {
                recorder.node(Operation::Subtract(number, second))
            }
        }
    }
}

impl Mul for Expression<'_> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        match (self, other) {
            (Self::Constant(value), _) => other.scale(value),
            (_, Self::Constant(value)) => self.scale(value),
            (Self::Node { recorder, number }, Self::Node { number: second, .. }) => {
                recorder.node(Operation::Multiply(number, second))
            }
        }
    }
}

impl Div for Expression<'_> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        match (self, other) {
            (_, Self::Constant(value)) => self.scale(1.0 / value),
            (Self::Constant(0.0), _) => self,
            (Self::Constant(value), Self::Node { recorder, number }) => {
                // No law divides a number by a variable; a constant numerator becomes a node.
                let numerator = recorder.number(Self::Constant(value));
                recorder.node(Operation::Divide(numerator, number))
            }
            (Self::Node { recorder, number }, Self::Node { number: second, .. }) => {
                recorder.node(Operation::Divide(number, second))
            }
        }
    }
}

impl Add<f64> for Expression<'_> {
    type Output = Self;

    fn add(self, other: f64) -> Self {
        self.offset(other)
    }
}

impl Sub<f64> for Expression<'_> {
    type Output = Self;

    fn sub(self, other: f64) -> Self {
        self.offset(-other)
    }
}

impl Mul<f64> for Expression<'_> {
    type Output = Self;

    fn mul(self, other: f64) -> Self {
        self.scale(other)
    }
}

impl Scalar for Expression<'_> {
    fn sin(self) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(libm::sin(value)),
            Self::Node { recorder, number } => recorder.circular(number).0,
        }
    }

    fn cos(self) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(libm::cos(value)),
            Self::Node { recorder, number } => recorder.circular(number).1,
        }
    }

    fn exp(self) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(libm::exp(value)),
            Self::Node { recorder, number } => recorder.node(Operation::Exponential(number)),
        }
    }
}
