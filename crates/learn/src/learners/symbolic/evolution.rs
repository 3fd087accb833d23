//! Drawing, crossover and mutation of sums of expressions.

use crate::expression::{Expression, Function, Operator, Variable};
use rand::{Rng, RngExt};

/// Building blocks of expressions, and their limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grammar {
    /// True where there is an input.
    pub(super) driven: bool,
    /// True where positions are angles, of which there are sines.
    pub(super) angle: bool,
    /// Most parts of a sum.
    pub(super) most_parts: usize,
    /// Most nodes of a part.
    pub(super) most_nodes: usize,
}

/// Share of operators among the inner nodes, the others being functions.
const JOINS: f64 = 0.6;

/// Share of leaves among the nodes that may be something else.
const EARLY_LEAVES: f64 = 0.35;

/// Share of numbers among the leaves.
const NUMBERS: f64 = 0.15;

fn one_of<T: Copy, G: Rng>(from: &[T], otherwise: T, generator: &mut G) -> T {
    from.get(generator.random_range(0..from.len().max(1))).copied().unwrap_or(otherwise)
}

impl Grammar {
    /// A drawn expression of at most `depth` levels below its root.
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
            // Elsewhere than at turning points a law is smooth.
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
            // Two digits: what is finer is up to the weights.
            let value: f64 = generator.random_range(-3.0..3.0);
            return Expression::Number((10.0 * value).round() / 10.0);
        }
        let variables = [Variable::Position, Variable::Velocity, Variable::Input];
        let count = if self.driven { 3 } else { 2 };
        Expression::Variable(one_of(
            // Two or three of three.
            variables.get(..count).unwrap_or_default(),
            Variable::Position,
            generator,
        ))
    }

    /// A drawn sum.
    pub(super) fn sum<G: Rng>(&self, generator: &mut G) -> Vec<Expression> {
        let count = generator.random_range(1..=self.most_parts.clamp(1, 4));
        (0..count).map(|_| self.draw(2, generator)).collect()
    }

    /// A child of two sums: parts of both; or one part added, left out, replaced, or varied.
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

    /// An expression with one of its subexpressions drawn anew.
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

    /// At most the parts that there may be, none too large and none twice.
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
