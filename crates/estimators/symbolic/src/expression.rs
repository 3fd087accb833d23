//! Expressions in x, with their values and derivatives at many points at once.

#![allow(clippy::indexing_slicing, reason = "operands come before their operation")]

use crate::operators::{Binary, Unary};

/// Node of an expression tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Node {
    /// Constant, to be fitted.
    Constant(f64),
    /// Variable x.
    Time,
    Unary(Unary),
    Binary(Binary),
}

impl Node {
    pub(crate) fn arity(self) -> usize {
        match self {
            Self::Constant(_) | Self::Time => 0,
            Self::Unary(_) => 1,
            Self::Binary(_) => 2,
        }
    }
}

/// Expression tree, with its nodes in postfix order: operands before their operator, the root last.
///
/// Invariant: every operator finds its operands, and one value is left.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Expression {
    nodes: Vec<Node>,
}

/// Columns of numbers, one per node of the current expression and with one point per row. They are kept
/// between evaluations to avoid allocations.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    values: Vec<Vec<f64>>,
    /// Derivatives of the root by each node.
    adjoints: Vec<Vec<f64>>,
    /// Indices of nodes whose values wait for their operator.
    stack: Vec<usize>,
    /// Indices of the operands of each node.
    operands: Vec<[usize; 2]>,
}

impl Expression {
    pub(crate) fn constant(value: f64) -> Self {
        Self { nodes: vec![Node::Constant(value)] }
    }

    pub(crate) fn time() -> Self {
        Self { nodes: vec![Node::Time] }
    }

    pub(crate) fn unary(operator: Unary, mut operand: Self) -> Self {
        operand.nodes.push(Node::Unary(operator));
        operand
    }

    pub(crate) fn binary(operator: Binary, mut left: Self, right: &Self) -> Self {
        left.nodes.extend_from_slice(&right.nodes);
        left.nodes.push(Node::Binary(operator));
        left
    }

    pub(crate) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Returns the number of nodes: the complexity.
    pub(crate) fn complexity(&self) -> usize {
        self.nodes.len()
    }

    /// Returns the index range of the subtree whose root is the node at an index.
    pub(crate) fn subtree(&self, root: usize) -> std::ops::Range<usize> {
        let mut needed = 1;
        let mut start = root + 1;
        for node in self.nodes.iter().take(root + 1).rev() {
            needed += node.arity();
            needed -= 1;
            start -= 1;
            if needed == 0 {
                break;
            }
        }
        start..root + 1
    }

    /// Returns the subtree whose root is the node at an index as a separate expression.
    pub(crate) fn take(&self, root: usize) -> Self {
        Self { nodes: self.nodes.get(self.subtree(root)).unwrap_or(&self.nodes).to_vec() }
    }

    /// Returns this expression with the subtree at an index replaced.
    pub(crate) fn with_subtree(&self, root: usize, replacement: &Self) -> Self {
        let mut nodes = self.nodes.clone();
        nodes.splice(self.subtree(root), replacement.nodes.iter().copied());
        Self { nodes }
    }

    /// Returns this expression with the node at an index replaced by one of the same arity.
    pub(crate) fn with_node(mut self, index: usize, replacement: Node) -> Self {
        if let Some(node) = self.nodes.get_mut(index).filter(|node| node.arity() == replacement.arity()) {
            *node = replacement;
        }
        self
    }

    /// Returns the constants, in order.
    pub(crate) fn constants(&self) -> impl Iterator<Item = f64> {
        self.nodes.iter().filter_map(|node| match node {
            Node::Constant(value) => Some(*value),
            _ => None,
        })
    }

    /// Sets the constants, in order.
    pub(crate) fn set_constants(&mut self, constants: &[f64]) {
        let places = self.nodes.iter_mut().filter_map(|node| match node {
            Node::Constant(value) => Some(value),
            _ => None,
        });
        places.zip(constants).for_each(|(place, constant)| *place = *constant);
    }

    /// Returns a key that is equal for two expressions that differ only in their constants.
    pub(crate) fn structure(&self) -> Vec<u8> {
        self.nodes
            .iter()
            .map(|node| match node {
                Node::Constant(_) => 0,
                Node::Time => 1,
                Node::Unary(operator) => 2 + *operator as u8,
                Node::Binary(operator) => 16 + *operator as u8,
            })
            .collect()
    }

    /// Returns the expression with every subtree of constants replaced by its value: the same function, with
    /// one constant where there were several.
    pub(crate) fn folded(&self) -> Self {
        let mut nodes: Vec<Node> = Vec::with_capacity(self.nodes.len());
        for &node in &self.nodes {
            let value = match (node, nodes.as_slice()) {
                (Node::Unary(operator), [.., Node::Constant(a)]) => Some(operator.value(*a)),
                (Node::Binary(operator), [.., Node::Constant(a), Node::Constant(b)]) => {
                    Some(operator.value(*a, *b))
                }
                _ => None,
            };
            match value {
                Some(value) => {
                    nodes.truncate(nodes.len() - node.arity());
                    nodes.push(Node::Constant(value));
                }
                None => nodes.push(node),
            }
        }
        Self { nodes }
    }

    /// Returns `true` if interval arithmetic proves that the expression is finite on all of 0..1: there is no
    /// pole and no edge of a domain between the points. A rejected expression may still be sound; an accepted
    /// one is.
    ///
    /// Reference: Keijzer, EuroGP 2003, LNCS 2610, 70, section 2.
    pub(crate) fn is_sound(&self) -> bool {
        let mut stack: Vec<[f64; 2]> = Vec::new();
        for node in &self.nodes {
            let range = match node {
                Node::Constant(value) => Some([*value, *value]),
                Node::Time => Some([0.0, 1.0]),
                Node::Unary(operator) => stack.pop().and_then(|range| operator.range(range)),
                Node::Binary(operator) => {
                    let right = stack.pop();
                    stack.pop().zip(right).and_then(|(left, right)| operator.range(left, right))
                }
            };
            match range.filter(|range| range.iter().all(|bound| bound.is_finite())) {
                Some(range) => stack.push(range),
                None => return false,
            }
        }
        true
    }
}

impl Workspace {
    /// Evaluates an expression at points.
    pub(crate) fn values(&mut self, expression: &Expression, points: &[f64]) -> &[f64] {
        let count = expression.nodes.len();
        if self.values.len() < count {
            self.values.resize_with(count, Vec::new);
        }
        self.stack.clear();
        self.operands.clear();
        for (index, node) in expression.nodes.iter().enumerate() {
            let (done, rest) = self.values.split_at_mut(index);
            let Some(column) = rest.first_mut() else { break };
            column.clear();
            debug_assert!(self.stack.len() >= node.arity(), "operands come before their operation");
            let operands = match node {
                Node::Constant(value) => {
                    column.resize(points.len(), *value);
                    [0, 0]
                }
                Node::Time => {
                    column.extend_from_slice(points);
                    [0, 0]
                }
                Node::Unary(operator) => {
                    let Some(of) = self.stack.pop() else { break };
                    operator.apply(&done[of], column);
                    [of, of]
                }
                Node::Binary(operator) => {
                    let (Some(right), Some(left)) = (self.stack.pop(), self.stack.pop()) else { break };
                    let pairs = done[left].iter().zip(&done[right]);
                    column.extend(pairs.map(|(&a, &b)| operator.value(a, b)));
                    [left, right]
                }
            };
            self.operands.push(operands);
            self.stack.push(index);
        }
        self.values.get(count.wrapping_sub(1)).map_or(&[], |column| column)
    }

    /// Returns the exact derivatives by each constant, in order, of the expression that was evaluated last,
    /// by one pass from the root down. A node of a tree has one parent, so that every derivative is a
    /// product.
    pub(crate) fn derivatives(&mut self, expression: &Expression, points: usize) -> Vec<&[f64]> {
        let count = expression.nodes.len();
        if self.adjoints.len() < count {
            self.adjoints.resize_with(count, Vec::new);
        }
        if let Some(root) = self.adjoints.get_mut(count.wrapping_sub(1)) {
            root.clear();
            root.resize(points, 1.0);
        }
        for (index, (node, &[left, right])) in expression.nodes.iter().zip(&self.operands).enumerate().rev() {
            let (below, own) = self.adjoints.split_at_mut(index);
            let (Some(own), Some(value)) = (own.first(), self.values.get(index)) else { continue };
            let (Some(a), Some(b)) = (self.values.get(left), self.values.get(right)) else { continue };
            match node {
                Node::Constant(_) | Node::Time => {}
                Node::Unary(operator) => {
                    if let Some(target) = below.get_mut(left) {
                        target.clear();
                        let pairs = own.iter().zip(a).zip(value);
                        target.extend(pairs.map(|((own, &a), &value)| own * operator.slope(a, value)));
                    }
                }
                Node::Binary(operator) => {
                    if let Some(target) = below.get_mut(left) {
                        target.clear();
                        let pairs = own.iter().zip(b);
                        target.extend(pairs.map(|(own, &b)| own * operator.left_slope(b)));
                    }
                    if let Some(target) = below.get_mut(right) {
                        target.clear();
                        let pairs = own.iter().zip(a).zip(b);
                        target.extend(pairs.map(|((own, &a), &b)| own * operator.right_slope(a, b)));
                    }
                }
            }
        }
        let columns = expression.nodes.iter().zip(&self.adjoints);
        columns
            .filter(|(node, _)| matches!(node, Node::Constant(_)))
            .map(|(_, column)| column.as_slice())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sample expression (2·x + 0.5)² ÷ exp(0.3 − x) + log(sqrt(1.5)·sin(x + 0.1) + 1).
    fn sample() -> Expression {
        use Node::{Constant, Time};
        let binary = Node::Binary;
        let unary = Node::Unary;
        let nodes = vec![
            Constant(2.0),
            Time,
            binary(Binary::Multiply),
            Constant(0.5),
            binary(Binary::Add),
            unary(Unary::Square),
            Constant(0.3),
            Time,
            binary(Binary::Subtract),
            unary(Unary::Exp),
            binary(Binary::Divide),
            Constant(1.5),
            unary(Unary::SquareRoot),
            Time,
            Constant(0.1),
            binary(Binary::Add),
            unary(Unary::Sine),
            binary(Binary::Multiply),
            Constant(1.0),
            binary(Binary::Add),
            unary(Unary::Log),
            binary(Binary::Add),
        ];
        Expression { nodes }
    }

    #[test]
    fn values_are_those_of_the_formula() {
        for x in [0.0, 0.3, 1.0_f64] {
            let expected =
                (2.0 * x + 0.5).powi(2) / (0.3 - x).exp() + (1.5_f64.sqrt() * (x + 0.1).sin() + 1.0).ln();
            let found = Workspace::default().values(&sample(), &[x])[0];
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let points = [0.0, 0.25, 0.9];
        let (mut workspace, expression, step) = (Workspace::default(), sample(), 1e-6);
        workspace.values(&expression, &points);
        let exact: Vec<Vec<f64>> =
            workspace.derivatives(&expression, 3).into_iter().map(<[f64]>::to_vec).collect();
        let constants: Vec<f64> = expression.constants().collect();
        assert_eq!(exact.len(), constants.len());
        for (which, exact) in exact.iter().enumerate() {
            let mut at = |way: f64| {
                let mut moved = (expression.clone(), constants.clone());
                moved.1[which] += way;
                moved.0.set_constants(&moved.1);
                workspace.values(&moved.0, &points).to_vec()
            };
            let (up, down) = (at(step), at(-step));
            for ((up, down), exact) in up.iter().zip(&down).zip(exact) {
                let difference = (up - down) / (2.0 * step);
                assert!((difference - exact).abs() < 1e-8 * (1.0 + exact.abs()), "{which}");
            }
        }
    }

    #[test]
    fn subtrees_are_found_and_replaced() {
        let expression = sample();
        assert_eq!(expression.subtree(10), 0..11);
        assert_eq!(expression.subtree(9), 6..10);
        assert_eq!(expression.subtree(21), 0..22);
        assert_eq!(expression.take(2).complexity(), 3);
        assert_eq!(expression.with_subtree(10, &Expression::time()).complexity(), 12);
        assert_eq!(expression.with_subtree(21, &Expression::time()), Expression::time());
    }

    #[test]
    fn constants_alone_fold_to_one() {
        let folded = sample().folded();
        assert_eq!(folded.complexity(), 21);
        let [one, other] =
            [sample(), folded].map(|expression| Workspace::default().values(&expression, &[0.4])[0]);
        assert_eq!(one, other);
    }

    #[test]
    fn poles_within_the_record_are_seen() {
        let shifted =
            |by: f64| Expression::binary(Binary::Subtract, Expression::time(), &Expression::constant(by));
        for (by, sound) in [(0.5, false), (0.0, false), (1.0, false), (-0.1, true), (1.1, true)] {
            let inverse = Expression::binary(Binary::Divide, Expression::constant(1.0), &shifted(by));
            assert_eq!(inverse.is_sound(), sound, "{by}");
        }
        assert!(!Expression::unary(Unary::Log, shifted(0.5)).is_sound());
        assert!(Expression::unary(Unary::SquareRoot, shifted(0.0)).is_sound());
        assert!(sample().is_sound());
    }
}
