//! Terms of a law, and the field that they make up.

use crate::Place;
use crate::expression::Expression;
use crate::flow::{Field, Slope};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Term of the acceleration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Term {
    /// 1: a constant torque, or a shifted rest position.
    #[serde(rename = "1")]
    Constant,
    /// θ: a spring.
    #[serde(rename = "theta")]
    Position,
    /// θ̇: viscous friction.
    #[serde(rename = "theta_dot")]
    Velocity,
    /// θ²: a spring with different stiffness on the two sides.
    #[serde(rename = "theta^2")]
    Square,
    /// θ³: a hardening or softening spring.
    #[serde(rename = "theta^3")]
    Cube,
    /// sign θ̇: dry friction.
    #[serde(rename = "sign(theta_dot)")]
    Direction,
    /// θ̇·|θ̇|: drag.
    #[serde(rename = "theta_dot*|theta_dot|")]
    Drag,
    /// sin θ: gravity.
    #[serde(rename = "sin(theta)")]
    Sine,
    /// cos θ: gravity, if the weight does not hang at θ = 0.
    #[serde(rename = "cos(theta)")]
    Cosine,
    /// u: the input.
    #[serde(rename = "u")]
    Input,
    /// User-defined term.
    #[serde(rename = "own")]
    Own(Expression),
}

impl Term {
    /// All built-in terms.
    pub const ALL: [Self; 10] = [
        Self::Constant,
        Self::Position,
        Self::Velocity,
        Self::Square,
        Self::Cube,
        Self::Direction,
        Self::Drag,
        Self::Sine,
        Self::Cosine,
        Self::Input,
    ];

    /// Returns the name used in configurations and tables.
    #[must_use]
    pub fn name(&self) -> Cow<'static, str> {
        let name = match self {
            Self::Constant => "1",
            Self::Position => "theta",
            Self::Velocity => "theta_dot",
            Self::Square => "theta^2",
            Self::Cube => "theta^3",
            Self::Direction => "sign(theta_dot)",
            Self::Drag => "theta_dot*|theta_dot|",
            Self::Sine => "sin(theta)",
            Self::Cosine => "cos(theta)",
            Self::Input => "u",
            Self::Own(expression) => return Cow::Owned(expression.to_string()),
        };
        Cow::Borrowed(name)
    }

    /// Returns the unit of the term's coefficient, for positions in `unit`.
    #[must_use]
    pub fn unit(&self, unit: &str) -> String {
        match self {
            Self::Constant | Self::Direction | Self::Sine | Self::Cosine => format!("{unit}/s^2"),
            Self::Position => "1/s^2".to_owned(),
            Self::Velocity => "1/s".to_owned(),
            Self::Square => format!("1/(s^2 {unit})"),
            Self::Cube => format!("1/(s^2 {unit}^2)"),
            Self::Drag => format!("1/{unit}"),
            Self::Input => format!("{unit}/s^2 per unit of u"),
            Self::Own(_) => format!("{unit}/s^2 per unit of the term"),
        }
    }

    /// Returns the term's value at a state.
    #[must_use]
    pub fn value(&self, place: &Place) -> f64 {
        let Place { position: x, velocity: v, direction, input } = *place;
        match self {
            Self::Constant => 1.0,
            Self::Position => x,
            Self::Velocity => v,
            Self::Square => x * x,
            Self::Cube => x * x * x,
            Self::Direction => direction,
            Self::Drag => direction * v * v,
            Self::Sine => x.sin(),
            Self::Cosine => x.cos(),
            Self::Input => input,
            Self::Own(expression) => expression.dual(place)[0],
        }
    }

    /// Returns the term's derivatives with respect to position and velocity.
    #[must_use]
    pub fn slope(&self, place: &Place) -> [f64; 2] {
        let Place { position: x, velocity: v, direction, .. } = *place;
        match self {
            Self::Constant | Self::Direction | Self::Input => [0.0, 0.0],
            Self::Position => [1.0, 0.0],
            Self::Velocity => [0.0, 1.0],
            Self::Square => [2.0 * x, 0.0],
            Self::Cube => [3.0 * x * x, 0.0],
            Self::Drag => [0.0, 2.0 * direction * v],
            Self::Sine => [x.cos(), 0.0],
            Self::Cosine => [-x.sin(), 0.0],
            Self::Own(expression) => {
                let [_, by_x, by_v] = expression.dual(place);
                [by_x, by_v]
            }
        }
    }

    /// Returns `true` if the term depends on the direction of the motion.
    #[must_use]
    pub fn is_directed(&self) -> bool {
        match self {
            Self::Own(expression) => expression.is_directed(),
            other => matches!(other, Self::Direction | Self::Drag),
        }
    }
}

/// Weighted sum of terms.
#[derive(Debug, Clone, PartialEq)]
pub struct Library {
    terms: Vec<Term>,
}

impl Library {
    /// Builds a law with these terms.
    #[must_use]
    pub fn new(terms: Vec<Term>) -> Self {
        Self { terms }
    }

    /// Returns the terms.
    #[must_use]
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Returns the law as text.
    #[must_use]
    pub fn equation(&self, weights: &[f64]) -> String {
        let mut text = "theta_ddot =".to_owned();
        for (number, (term, weight)) in self.terms.iter().zip(weights).enumerate() {
            let weight = signed(number, *weight);
            text.push_str(&match term {
                Term::Constant => weight,
                Term::Own(own) => format!("{weight}*({own})"),
                _ => format!("{weight}*{}", term.name()),
            });
        }
        if self.terms.is_empty() { text + " 0" } else { text }
    }
}

impl Field for Library {
    fn weights(&self) -> usize {
        self.terms.len()
    }

    fn is_directed(&self) -> bool {
        self.terms.iter().any(|term| term.is_directed())
    }

    fn acceleration(&self, weights: &[f64], place: &Place) -> f64 {
        self.terms.iter().zip(weights).map(|(term, weight)| weight * term.value(place)).sum()
    }

    fn sloped(&self, weights: &[f64], place: &Place, slope: &mut Slope) -> f64 {
        (slope.position, slope.velocity) = (0.0, 0.0);
        let mut sum = 0.0;
        for ((term, weight), own) in self.terms.iter().zip(weights).zip(&mut slope.weights) {
            let value = term.value(place);
            let [position, velocity] = term.slope(place);
            *own = value;
            sum += weight * value;
            slope.position += weight * position;
            slope.velocity += weight * velocity;
        }
        sum
    }
}

/// Formats a summand's weight with its sign; `number` is 0 for the first summand, as in "a = -1.00000*b +
/// 2.00000*c".
pub(crate) fn signed(number: usize, weight: f64) -> String {
    let sign = match (number, weight < 0.0) {
        (0, true) => " -",
        (0, false) => " ",
        (_, true) => " - ",
        (_, false) => " + ",
    };
    format!("{sign}{:.5}", weight.abs())
}

/// Formats a sum of weights times terms, each of which begins with its sign of multiplication.
pub(crate) fn weighted(terms: &[(f64, &str)]) -> String {
    let one = |(number, (weight, term)): (usize, &(f64, &str))| format!("{}{term}", signed(number, *weight));
    terms.iter().enumerate().map(one).collect()
}
