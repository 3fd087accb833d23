//! Derivatives of a recorded field by one backward sweep.

use super::expression::Operation;
use super::graph::Graph;
use super::node::Node;
use super::series::{Adjoint, Series, convolve, dot_reversed, first, head};

impl Graph {
    /// Computes the derivative series of a node with respect to every other, up to and including `degree`.
    ///
    /// # Reference
    /// Griewank, Walther, Evaluating Derivatives, 2nd ed., SIAM 2008, sections 3.2 and 13.
    pub(crate) fn differentiate(&mut self, output: usize, degree: usize) {
        let Self { nodes, series, adjoints, .. } = self;
        for adjoint in adjoints.iter_mut() {
            adjoint.clear();
        }
        if let Some(adjoint) = adjoints.get_mut(output) {
            adjoint.length = 1;
            let [first, ..] = &mut adjoint.series;
            *first = 1.0;
        }
        for number in (0..=output).rev() {
            let Some((lower, [own, ..])) = adjoints.split_at_mut_checked(number) else { continue };
            let Some(node) = nodes.get(number).filter(|node| own.length > 0 && node.wanted) else { continue };
            let mut sweep = Sweep { nodes, series, lower, count: degree + 1 };
            match node.operation {
                Operation::Leaf(_) => {}
                Operation::Add(a, b) => {
                    sweep.pass(a, own, 1.0);
                    sweep.pass(b, own, 1.0);
                }
                Operation::Subtract(a, b) => {
                    sweep.pass(a, own, 1.0);
                    sweep.pass(b, own, -1.0);
                }
                Operation::Scale(a, factor) => sweep.pass(a, own, factor),
                Operation::Offset(a, _) => sweep.pass(a, own, 1.0),
                Operation::Multiply(a, b) => {
                    sweep.pass_product(a, own, b, 1.0);
                    sweep.pass_product(b, own, a, 1.0);
                }
                Operation::Divide(a, b) => {
                    let divided = sweep.divided(own, b);
                    sweep.pass(a, &divided, 1.0);
                    sweep.pass_product(b, &divided, number, -1.0);
                }
                Operation::Sine(a) => sweep.pass_product(a, own, number + 1, 1.0),
                Operation::Cosine(a) => sweep.pass_product(a, own, number.saturating_sub(1), -1.0),
                Operation::Exponential(a) => sweep.pass_product(a, own, number, 1.0),
            }
        }
    }

    /// Returns the derivative series with respect to a leaf, up to its last coefficient that may differ from
    /// zero.
    pub(crate) fn derivative(&self, leaf: usize) -> &[f64] {
        let adjoint = self.leaf_node(leaf).and_then(|node| self.adjoints.get(node));
        // A leaf that the result does not depend on has no node.
        adjoint.map_or(&[], |adjoint| head(&adjoint.series, adjoint.length))
    }
}

/// State of the sweep at one node: the adjoints of earlier nodes are still being accumulated.
struct Sweep<'a> {
    nodes: &'a [Node],
    series: &'a [Series],
    lower: &'a mut [Adjoint],
    count: usize,
}

impl Sweep<'_> {
    fn target(&mut self, operand: usize) -> Option<&mut Adjoint> {
        let wanted = self.nodes.get(operand).is_some_and(|node| node.wanted);
        self.lower.get_mut(operand).filter(|_| wanted)
    }

    fn is_constant(&self, number: usize) -> bool {
        self.nodes.get(number).is_some_and(|node| node.constant)
    }

    /// Adds a multiple of an adjoint to an operand's.
    fn pass(&mut self, operand: usize, adjoint: &Adjoint, factor: f64) {
        let Some(target) = self.target(operand) else { return };
        target.length = target.length.max(adjoint.length);
        for (target, value) in target.series.iter_mut().zip(&adjoint.series).take(adjoint.length) {
            *target += factor * value;
        }
    }

    /// Adds the product of an adjoint and another node's series to an operand's adjoint.
    fn pass_product(&mut self, operand: usize, adjoint: &Adjoint, by: usize, factor: f64) {
        let (all, count) = (self.series, self.count);
        let Some(series) = all.get(by) else { return };
        if self.is_constant(by) {
            return self.pass(operand, adjoint, factor * first(series));
        }
        let Some(target) = self.target(operand) else { return };
        target.length = target.length.max(count);
        if adjoint.length == 1 {
            let factor = factor * first(&adjoint.series);
            for (target, value) in target.series.iter_mut().zip(series).take(count) {
                *target += factor * value;
            }
            return;
        }
        for (degree, target) in target.series.iter_mut().enumerate().take(count) {
            *target += factor * convolve(&adjoint.series, series, degree);
        }
    }

    /// Returns an adjoint divided by a node's series.
    fn divided(&self, adjoint: &Adjoint, by: usize) -> Adjoint {
        let mut quotient = *adjoint;
        let Some(series) = self.series.get(by) else { return quotient };
        if self.is_constant(by) {
            quotient.series = quotient.series.map(|value| value / first(series));
            return quotient;
        }
        quotient.length = self.count;
        for degree in 0..self.count {
            let [_, divisor @ ..] = series;
            let known = dot_reversed(head(&quotient.series, degree), head(divisor, degree));
            if let Some(slot) = quotient.series.get_mut(degree) {
                *slot = (*slot - known) / first(series);
            }
        }
        quotient
    }
}
