//! Expressions of position, velocity and input: parsed from text, evaluated with derivatives, written as
//! text.
//!
//! Grammar: numbers, `theta`, `theta_dot`, `u`, `pi`; `+ - * /`, `^` with a whole exponent; parentheses,
//! `|…|`; the functions of [`Function`]. `sign(theta_dot)` and `|theta_dot|` follow the direction of the
//! motion, also at rest.

mod parse;

pub use parse::Unreadable;

use crate::Place;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Variable of an expression.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variable {
    /// Position, `theta`.
    Position,
    /// Velocity, `theta_dot`.
    Velocity,
    /// Input, `u`.
    Input,
}

impl Variable {
    /// All variables.
    pub const ALL: [Self; 3] = [Self::Position, Self::Velocity, Self::Input];

    /// Returns the variable's name in text.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "theta",
            Self::Velocity => "theta_dot",
            Self::Input => "u",
        }
    }
}

/// Function of one argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    /// Sine of an angle in rad.
    Sin,
    /// Cosine of an angle in rad.
    Cos,
    /// Hyperbolic tangent.
    Tanh,
    /// Exponential.
    Exp,
    /// Natural logarithm.
    Log,
    /// Square root.
    Sqrt,
    /// Absolute value.
    Abs,
    /// Sign: 1, −1, or 0 at zero.
    Sign,
}

impl Function {
    /// All functions.
    pub const ALL: [Self; 8] =
        [Self::Sin, Self::Cos, Self::Tanh, Self::Exp, Self::Log, Self::Sqrt, Self::Abs, Self::Sign];

    /// Returns the function's name in text.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Tanh => "tanh",
            Self::Exp => "exp",
            Self::Log => "log",
            Self::Sqrt => "sqrt",
            Self::Abs => "abs",
            Self::Sign => "sign",
        }
    }

    /// Returns value and derivative at `x`.
    fn at(self, x: f64) -> [f64; 2] {
        match self {
            Self::Sin => [x.sin(), x.cos()],
            Self::Cos => [x.cos(), -x.sin()],
            Self::Tanh => [x.tanh(), 1.0 - x.tanh().powi(2)],
            Self::Exp => [x.exp(), x.exp()],
            Self::Log => [x.ln(), x.recip()],
            Self::Sqrt => [x.sqrt(), 0.5 / x.sqrt()],
            Self::Abs => [x.abs(), sign(x)],
            Self::Sign => [sign(x), 0.0],
        }
    }
}

fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

/// Binary operator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operator {
    /// Sum.
    Add,
    /// Difference.
    Subtract,
    /// Product.
    Multiply,
    /// Quotient.
    Divide,
}

/// Expression tree.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Expression {
    /// A number.
    Number(f64),
    /// A variable.
    Variable(Variable),
    /// A function of an expression.
    Call(Function, Box<Self>),
    /// Binary operation on two expressions.
    Join(Operator, Box<Self>, Box<Self>),
    /// Whole power of an expression.
    Power(Box<Self>, i32),
}

/// Value, derivative with respect to position, and derivative with respect to velocity.
pub type Dual = [f64; 3];

impl Expression {
    /// Returns value and derivatives at a state.
    #[must_use]
    pub fn dual(&self, place: &Place) -> Dual {
        match self {
            Self::Number(value) => [*value, 0.0, 0.0],
            Self::Variable(Variable::Position) => [place.position, 1.0, 0.0],
            Self::Variable(Variable::Velocity) => [place.velocity, 0.0, 1.0],
            Self::Variable(Variable::Input) => [place.input, 0.0, 0.0],
            Self::Call(function, of) => match (function, of.as_ref()) {
                (Function::Sign, Self::Variable(Variable::Velocity)) => [place.direction, 0.0, 0.0],
                (Function::Abs, Self::Variable(Variable::Velocity)) => {
                    [place.direction * place.velocity, 0.0, place.direction]
                }
                _ => {
                    let [x, by_x, by_v] = of.dual(place);
                    let [value, slope] = function.at(x);
                    [value, slope * by_x, slope * by_v]
                }
            },
            Self::Join(operator, left, right) => {
                let ([a, ax, av], [b, bx, bv]) = (left.dual(place), right.dual(place));
                match operator {
                    Operator::Add => [a + b, ax + bx, av + bv],
                    Operator::Subtract => [a - b, ax - bx, av - bv],
                    Operator::Multiply => [a * b, ax * b + a * bx, av * b + a * bv],
                    Operator::Divide => {
                        let value = a / b;
                        [value, (ax - value * bx) / b, (av - value * bv) / b]
                    }
                }
            }
            Self::Power(base, exponent) => {
                let [x, by_x, by_v] = base.dual(place);
                let slope = f64::from(*exponent) * x.powi(exponent - 1);
                [x.powi(*exponent), slope * by_x, slope * by_v]
            }
        }
    }

    /// Returns `true` if the value depends on the direction of the motion.
    #[must_use]
    pub fn is_directed(&self) -> bool {
        match self {
            Self::Number(_) | Self::Variable(_) => false,
            Self::Call(Function::Sign | Function::Abs, of) if of.reads(Variable::Velocity) => true,
            Self::Call(_, of) | Self::Power(of, _) => of.is_directed(),
            Self::Join(_, left, right) => left.is_directed() || right.is_directed(),
        }
    }

    /// Returns `true` if the expression contains the variable.
    #[must_use]
    pub fn reads(&self, variable: Variable) -> bool {
        match self {
            Self::Number(_) => false,
            Self::Variable(own) => *own == variable,
            Self::Call(_, of) | Self::Power(of, _) => of.reads(variable),
            Self::Join(_, left, right) => left.reads(variable) || right.reads(variable),
        }
    }

    /// Returns the number of numbers, variables, functions and operators: the complexity.
    #[must_use]
    pub fn nodes(&self) -> usize {
        match self {
            Self::Number(_) | Self::Variable(_) => 1,
            Self::Call(_, of) | Self::Power(of, _) => 1 + of.nodes(),
            Self::Join(_, left, right) => 1 + left.nodes() + right.nodes(),
        }
    }
}

/// Returns the precedence of the outermost operation.
fn binding(expression: &Expression) -> u8 {
    match expression {
        Expression::Join(Operator::Add | Operator::Subtract, ..) => 0,
        Expression::Join(..) => 1,
        Expression::Number(value) if *value < 0.0 => 1,
        Expression::Power(..) => 2,
        _ => 3,
    }
}

impl fmt::Display for Expression {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let within = |part: &Self, least: u8| {
            if binding(part) < least { format!("({part})") } else { part.to_string() }
        };
        match self {
            Self::Number(value) => write!(to, "{value}"),
            Self::Variable(variable) => to.write_str(variable.name()),
            Self::Call(Function::Abs, of) if !of.to_string().contains('|') => write!(to, "|{of}|"),
            Self::Call(function, of) => write!(to, "{}({of})", function.name()),
            Self::Power(base, exponent) => write!(to, "{}^{exponent}", within(base, 3)),
            Self::Join(operator, left, right) => {
                let (word, least, beyond) = match operator {
                    Operator::Add => (" + ", 0, 1),
                    Operator::Subtract => (" - ", 0, 1),
                    Operator::Multiply => ("*", 1, 2),
                    Operator::Divide => ("/", 1, 2),
                };
                write!(to, "{}{word}{}", within(left, least), within(right, beyond))
            }
        }
    }
}

impl From<Expression> for String {
    fn from(expression: Expression) -> Self {
        expression.to_string()
    }
}

#[cfg(test)]
mod tests;
