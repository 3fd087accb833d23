//! Random drawing, crossover and mutation of sums of expressions.

use crate::expression::{Expression, Function, Operator, Variable};
use rand::{Rng, RngExt};

/// Building blocks of expressions, and size limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grammar {
    /// `true` if there is an input.
    pub(super) driven: bool,
    /// `true` if positions are angles; only angles have sines.
    pub(super) angle: bool,
    /// Largest number of parts of a sum.
    pub(super) most_parts: usize,
    /// Largest number of nodes of a part.
    pub(super) most_nodes: usize,
}

/// Share of operators among the inner nodes; the others are functions.
const JOINS: f64 = 0.6;

/// Share of leaves among nodes that need not be leaves.
const EARLY_LEAVES: f64 = 0.35;

/// Share of numbers among the leaves.
const NUMBERS: f64 = 0.15;

fn one_of<T: Copy, G: Rng>(from: &[T], otherwise: T, generator: &mut G) -> T {
    from.get(generator.random_range(0..from.len().max(1))).copied().unwrap_or(otherwise)
}

impl Grammar {
    /// Draws an expression with at most `depth` levels below its root.
    pub(super) fn draw<G: Rng>(&self, depth: usize, generator: &mut G) -> Expression {
        if depth == 0 || generator.random_bool(EARLY_LEAVES) {
            return self.leaf(generator);
        }
        if generator.random_bool(JOINS) {
            let operators = [Operator::Add, Operator::Subtract, Operator::Multiply, Operator::Multiply];
            let operator = one_of(&operators, Operator::Multiply, generator);
            let left = Box::new(self.draw(depth - 1, generator));
            return Expression::Join(operator, left, Box::new(self.draw(depth - 1, generator)));
        }
        let function = one_of(self.functions(), Function::Abs, generator);
        let of = match function {
            // A law is smooth except at turning points, so only the velocity gets a sign or an absolute
            // value.
            Function::Sign | Function::Abs => Expression::Variable(Variable::Velocity),
            _ => self.draw(depth - 1, generator),
        };
        Expression::Call(function, Box::new(of))
    }

    fn functions(&self) -> &'static [Function] {
        const ALL: [Function; 5] =
            [Function::Sign, Function::Abs, Function::Tanh, Function::Sin, Function::Cos];
        if self.angle { &ALL } else { ALL.first_chunk::<3>().map_or(&[], |own| own.as_slice()) }
    }

    fn leaf<G: Rng>(&self, generator: &mut G) -> Expression {
        if generator.random_bool(NUMBERS) {
            // One decimal suffices; the weights supply finer values.
            let value: f64 = generator.random_range(-3.0..3.0);
            return Expression::Number((10.0 * value).round() / 10.0);
        }
        let variables: &[Variable] = if self.driven {
            &[Variable::Position, Variable::Velocity, Variable::Input]
        } else {
            &[Variable::Position, Variable::Velocity]
        };
        Expression::Variable(one_of(variables, Variable::Position, generator))
    }

    /// Draws a sum.
    pub(super) fn sum<G: Rng>(&self, generator: &mut G) -> Vec<Expression> {
        let count = generator.random_range(1..=self.most_parts.clamp(1, 4));
        (0..count).map(|_| self.draw(2, generator)).collect()
    }

    /// Returns a child of two sums: parts of both, or the first with one part added, removed, replaced or
    /// mutated.
    pub(super) fn child<G: Rng>(
        &self,
        [one, other]: [&[Expression]; 2],
        generator: &mut G,
    ) -> Vec<Expression> {
        let mut child = one.to_vec();
        let place = generator.random_range(0..child.len().max(1));
        match generator.random_range(0..10) {
            0..=2 => child.extend(other.iter().filter(|_| generator.random_bool(0.5)).cloned()),
            3..=5 => child.push(self.draw(3, generator)),
            6 if child.len() > 1 => {
                child.remove(place);
            }
            7 => {
                if let Some(part) = child.get_mut(place) {
                    *part = self.draw(3, generator);
                }
            }
            _ => {
                if let Some(part) = child.get_mut(place) {
                    *part = self.varied(part, generator);
                }
            }
        }
        self.tidied(child)
    }

    /// Returns an expression with one subexpression drawn anew.
    fn varied<G: Rng>(&self, part: &Expression, generator: &mut G) -> Expression {
        if generator.random_bool(1.0 / part.nodes() as f64) {
            return self.draw(2, generator);
        }
        match part {
            Expression::Join(operator, left, right) if generator.random_bool(0.5) => {
                Expression::Join(*operator, Box::new(self.varied(left, generator)), right.clone())
            }
            Expression::Join(operator, left, right) => {
                Expression::Join(*operator, left.clone(), Box::new(self.varied(right, generator)))
            }
            Expression::Call(function, of) if !matches!(function, Function::Sign | Function::Abs) => {
                Expression::Call(*function, Box::new(self.varied(of, generator)))
            }
            _ => self.draw(2, generator),
        }
    }

    /// Removes duplicate parts, parts that are too large, and parts beyond the largest number.
    pub(super) fn tidied(&self, parts: Vec<Expression>) -> Vec<Expression> {
        let mut kept: Vec<Expression> = Vec::new();
        for part in parts {
            let fits = part.nodes() <= self.most_nodes && kept.len() < self.most_parts;
            if fits && !kept.contains(&part) {
                kept.push(part);
            }
        }
        if kept.is_empty() { vec![Expression::Variable(Variable::Position)] } else { kept }
    }
}
