//! Creation of expressions, at random and from other expressions.

use crate::expression::{Expression, Node};
use crate::operators::{Binary, Unary};
use rand::{Rng, RngExt};

/// Grammar of random expressions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Grammar {
    /// Depth of the deepest random tree; a leaf has depth 0.
    pub(crate) depth: usize,
    /// `true` if the sine is one of the functions.
    pub(crate) sine: bool,
}

/// Share of operators with two operands.
const BINARY_SHARE: f64 = 0.65;

/// Share of constants among the leaves.
const CONSTANT_SHARE: f64 = 0.5;

/// Share of leaves among the nodes of a grown tree, above its depth.
const EARLY_LEAVES: f64 = 0.3;

/// Returns a random whole number below `end`; 0 if there is none.
fn below<G: Rng>(end: usize, generator: &mut G) -> usize {
    generator.random_range(0..end.max(1))
}

fn one_of<T: Copy, G: Rng>(from: &[T], otherwise: T, generator: &mut G) -> T {
    from.get(below(from.len(), generator)).copied().unwrap_or(otherwise)
}

impl Grammar {
    /// Creates the `index`-th tree of a population, ramped half and half: depths from 1 up in turn, with
    /// every other tree full and the others grown.
    ///
    /// Reference: Koza, Genetic Programming (MIT Press 1992), section 6.2.
    pub(crate) fn ramped<G: Rng>(&self, index: usize, generator: &mut G) -> Expression {
        let depth = 1 + index / 2 % self.depth;
        self.draw(depth, index.is_multiple_of(2), generator)
    }

    /// Draws a tree; a `full` one has all of its leaves at the given depth.
    pub(crate) fn draw<G: Rng>(&self, depth: usize, full: bool, generator: &mut G) -> Expression {
        let leaf = depth == 0 || (!full && generator.random_bool(EARLY_LEAVES));
        if leaf {
            return match self.leaf(generator) {
                Node::Constant(value) => Expression::constant(value),
                _ => Expression::time(),
            };
        }
        if generator.random_bool(BINARY_SHARE) {
            let operator = self.binary(generator);
            let left = self.draw(depth - 1, full, generator);
            let right = self.draw(depth - 1, full, generator);
            return Expression::binary(operator, left, &right);
        }
        Expression::unary(self.unary(generator), self.draw(depth - 1, full, generator))
    }

    fn leaf<G: Rng>(&self, generator: &mut G) -> Node {
        if generator.random_bool(CONSTANT_SHARE) {
            Node::Constant(generator.random_range(-1.0..1.0))
        } else {
            Node::Time
        }
    }

    fn unary<G: Rng>(&self, generator: &mut G) -> Unary {
        let known = Unary::ALL.len() - usize::from(!self.sine);
        // The sine is the last one.
        one_of(Unary::ALL.split_at(known).0, Unary::Exp, generator)
    }

    fn binary<G: Rng>(&self, generator: &mut G) -> Binary {
        one_of(&Binary::ALL, Binary::Add, generator)
    }

    /// Replaces one subtree of the first parent by a subtree of the other parent.
    pub(crate) fn crossover<G: Rng>(
        &self,
        parent: &Expression,
        other: &Expression,
        generator: &mut G,
    ) -> Expression {
        let place = below(parent.complexity(), generator);
        let graft = other.take(below(other.complexity(), generator));
        parent.with_subtree(place, &graft)
    }

    /// Replaces a subtree by a random one, or combines the whole tree with a random one, so that a tree can
    /// also grow at its root.
    pub(crate) fn mutate_subtree<G: Rng>(&self, parent: &Expression, generator: &mut G) -> Expression {
        let drawn = self.draw(2, false, generator);
        let place = below(parent.complexity() + 1, generator);
        if place == parent.complexity() {
            return Expression::binary(self.binary(generator), parent.clone(), &drawn);
        }
        parent.with_subtree(place, &drawn)
    }

    /// Replaces one node by another of the same arity; a constant may be changed instead.
    pub(crate) fn mutate_point<G: Rng>(&self, parent: &Expression, generator: &mut G) -> Expression {
        let place = below(parent.complexity(), generator);
        let node = match parent.nodes().get(place) {
            Some(Node::Unary(_)) => Node::Unary(self.unary(generator)),
            Some(Node::Binary(_)) => Node::Binary(self.binary(generator)),
            Some(Node::Constant(value)) if generator.random_bool(0.5) => {
                // The new value is between minus and plus twice the old one: another start for the fit.
                Node::Constant(value * generator.random_range(-2.0..2.0))
            }
            _ => self.leaf(generator),
        };
        parent.clone().with_node(place, node)
    }

    /// Returns one subtree alone.
    ///
    /// Reference: Poli, Langdon, McPhee, A Field Guide to Genetic Programming (2008), section 5.2.
    pub(crate) fn hoist<G: Rng>(&self, parent: &Expression, generator: &mut G) -> Expression {
        parent.take(below(parent.complexity(), generator))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expression::Workspace;
    use seed::Seed;

    const GRAMMAR: Grammar = Grammar { depth: 4, sine: true };

    /// Returns `true` if every operator has its operands and one value is left.
    fn is_tree(expression: &Expression) -> bool {
        let mut depth: isize = 0;
        let fits = expression.nodes().iter().all(|node| {
            depth -= node.arity() as isize;
            let fits = depth >= 0;
            depth += 1;
            fits
        });
        fits && depth == 1 && Workspace::default().values(expression, &[0.5]).len() == 1
    }

    #[test]
    fn whatever_is_drawn_or_varied_is_a_tree() {
        let mut generator = Seed::new(0).generator();
        let mut trees: Vec<Expression> =
            (0..200).map(|index| GRAMMAR.ramped(index, &mut generator)).collect();
        for index in 0..5000 {
            let one = trees[below(trees.len(), &mut generator)].clone();
            let other = &trees[below(trees.len(), &mut generator)];
            let next = match index % 4 {
                0 => GRAMMAR.crossover(&one, other, &mut generator),
                1 => GRAMMAR.mutate_subtree(&one, &mut generator),
                2 => GRAMMAR.mutate_point(&one, &mut generator),
                _ => GRAMMAR.hoist(&one, &mut generator),
            };
            assert!(is_tree(&next) && is_tree(&next.folded()), "{next:?}");
            if next.complexity() < 40 {
                trees.push(next);
            }
        }
    }

    #[test]
    fn half_of_the_trees_are_full_and_depths_are_ramped() {
        let mut generator = Seed::new(0).generator();
        let full = (0..400).step_by(2).map(|index| GRAMMAR.ramped(index, &mut generator));
        // A full tree of depth d has more nodes than d and fewer than 2^(d+1).
        for (index, tree) in full.enumerate() {
            let depth = 1 + index % 4;
            assert!((depth + 1..1 << (depth + 1)).contains(&tree.complexity()), "{depth} {tree:?}");
        }
    }

    #[test]
    fn without_the_sine_there_is_none() {
        let mut generator = Seed::new(0).generator();
        let grammar = Grammar { sine: false, ..GRAMMAR };
        let mut trees = (0..500).map(|index| grammar.ramped(index, &mut generator));
        assert!(trees.all(|tree| !tree.nodes().contains(&Node::Unary(Unary::Sine))));
    }
}
