//! Law of motion that is a weighted sum of expressions.

use crate::Place;
use crate::expression::Expression;
use crate::flow::{Field, Slope};
use crate::learners::library::signed;

/// Acceleration Σ wₖ·gₖ(θ, θ̇, u).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sum {
    pub(super) parts: Vec<Expression>,
}

impl Sum {
    /// Returns the number of nodes: those of all parts, plus one per part for its weight.
    pub(super) fn nodes(&self) -> usize {
        self.parts.iter().map(|part| 1 + part.nodes()).sum()
    }

    /// Returns the law as text.
    pub(super) fn equation(&self, weights: &[f64]) -> String {
        let mut text = "theta_ddot =".to_owned();
        for (number, (part, weight)) in self.parts.iter().zip(weights).enumerate() {
            let weight = signed(number, *weight);
            let part = match part {
                Expression::Join(..) => format!("({part})"),
                _ => part.to_string(),
            };
            text.push_str(&format!("{weight}*{part}"));
        }
        text
    }
}

impl Field for Sum {
    fn weights(&self) -> usize {
        self.parts.len()
    }

    fn is_directed(&self) -> bool {
        self.parts.iter().any(Expression::is_directed)
    }

    fn acceleration(&self, weights: &[f64], place: &Place) -> f64 {
        self.parts.iter().zip(weights).map(|(part, weight)| weight * part.dual(place)[0]).sum()
    }

    fn sloped(&self, weights: &[f64], place: &Place, slope: &mut Slope) -> f64 {
        (slope.position, slope.velocity) = (0.0, 0.0);
        let mut sum = 0.0;
        for ((part, weight), own) in self.parts.iter().zip(weights).zip(&mut slope.weights) {
            let [value, by_x, by_v] = part.dual(place);
            *own = value;
            sum += weight * value;
            slope.position += weight * by_x;
            slope.velocity += weight * by_v;
        }
        sum
    }
}
