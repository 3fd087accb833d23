//! Taylor series of a law and of its derivatives.

use super::expression::{Expression, Operation, Recorder};
use crate::edges::Edge;
use crate::field::{Field, Mode, SYSTEM_HIDDEN, State, Term};
use crate::law::MOST_PARAMETERS;
use crate::nominal::Coefficients;

/// Coefficients in a series; the highest degree is one less.
pub(crate) const LENGTH: usize = 20;

/// A Taylor series in the time since the step began.
pub(crate) type Series = [f64; LENGTH];

/// Numbers of the leaves: time, state, raw input, nominal coefficients, then [`MOST_PARAMETERS`] for each
/// effect.
pub(crate) const TIME: usize = 0;
/// Position and velocity, then the hidden state.
pub(crate) const STATE: usize = 1;
/// State variables of a system.
pub(crate) const MOST_STATES: usize = 2 + SYSTEM_HIDDEN;
/// The input before gain.
pub(crate) const INPUT: usize = STATE + MOST_STATES;
/// Inertia, damping, stiffness, rest angle, input gain.
pub(crate) const NOMINAL: usize = INPUT + 1;
/// Parameters of the first effect.
pub(crate) const EFFECTS: usize = NOMINAL + 5;

#[derive(Debug, Clone, Copy)]
struct Node {
    operation: Operation,
    /// Depends on parameters only.
    constant: bool,
    /// Depends on the state, or on a parameter that is free.
    wanted: bool,
    /// Its series is needed.
    used: bool,
}

/// The field of one mode, written down: rates of the state and margins of the edges.
#[derive(Debug, Clone)]
pub(crate) struct Graph {
    nodes: Vec<Node>,
    /// Nodes whose series have to be computed, in order.
    varying: Vec<usize>,
    /// Leaf number to node.
    leaves: Vec<Option<usize>>,
    /// The node of each state variable's rate.
    pub(crate) rates: Vec<usize>,
    pub(crate) edges: Vec<(Edge, usize)>,
    series: Vec<Series>,
    adjoints: Vec<Adjoint>,
    seed: usize,
}

/// A derivative of the output with respect to a node; coefficients from `length` on are zero.
#[derive(Debug, Clone, Copy)]
struct Adjoint {
    length: usize,
    series: Series,
}

const NO_ADJOINT: Adjoint = Adjoint { length: 0, series: [0.0; LENGTH] };

impl Graph {
    /// Writes down the field of a mode. `free` tells which leaves derivatives are wanted for, besides the
    /// state; `states` is the number of state variables.
    pub(crate) fn record(
        field: &Field<f64>,
        directed: bool,
        mode: &Mode,
        states: usize,
        free: &dyn Fn(usize) -> bool,
    ) -> Self {
        let recorder = Recorder::default();
        let leaf = |number| recorder.leaf(number);
        let nominal = Coefficients {
            inertia: leaf(NOMINAL),
            damping: leaf(NOMINAL + 1),
            stiffness: leaf(NOMINAL + 2),
            rest_angle: leaf(NOMINAL + 3),
            input_gain: leaf(NOMINAL + 4),
        };
        let terms = field.terms.iter().enumerate().map(|(number, term)| Term {
            effect: term.effect,
            values: std::array::from_fn(|index| leaf(EFFECTS + number * MOST_PARAMETERS + index)),
            hidden: term.hidden,
        });
        let written: Field<Expression<'_>> = Field { nominal, terms: terms.collect() };
        let position = leaf(STATE);
        let velocity = if mode.sticks() { Expression::Constant(0.0) } else { leaf(STATE + 1) };
        let state = State {
            time: leaf(TIME),
            position,
            velocity,
            hidden: std::array::from_fn(|index| leaf(STATE + 2 + index)),
            input: nominal.input_gain * leaf(INPUT),
        };
        let (acceleration, hidden) = written.rates(&state, mode);
        let rates: Vec<usize> = [velocity, acceleration]
            .into_iter()
            .chain(hidden)
            .take(states)
            .map(|rate| recorder.number(rate))
            .collect();
        let mut edges = Vec::new();
        written.edges(directed, &state, mode, |edge, margin| edges.push((edge, recorder.number(margin))));
        drop(written);
        Self::assemble(recorder.into_operations(), rates, edges, states, free)
    }

    fn assemble(
        operations: Vec<Operation>,
        rates: Vec<usize>,
        edges: Vec<(Edge, usize)>,
        states: usize,
        free: &dyn Fn(usize) -> bool,
    ) -> Self {
        let mut nodes: Vec<Node> = Vec::with_capacity(operations.len());
        for operation in operations {
            let (constant, wanted) = match operation {
                Operation::Leaf(leaf) => {
                    (leaf >= NOMINAL, (STATE..STATE + states).contains(&leaf) || free(leaf))
                }
                other => {
                    let of =
                        |number: usize| nodes.get(number).map_or((true, false), |n| (n.constant, n.wanted));
                    let (first, second) = operands(other);
                    let (first, second) = (of(first), second.map_or((true, false), of));
                    (first.0 && second.0, first.1 || second.1)
                }
            };
            nodes.push(Node { operation, constant, wanted, used: false });
        }
        let mut pending: Vec<usize> = rates.iter().copied().chain(edges.iter().map(|edge| edge.1)).collect();
        while let Some(number) = pending.pop() {
            let Some(node) = nodes.get_mut(number).filter(|node| !node.used) else { continue };
            node.used = true;
            match node.operation {
                Operation::Leaf(_) => {}
                operation => {
                    let (first, second) = operands(operation);
                    pending.extend([first].into_iter().chain(second));
                    // Sine and cosine need each other's series.
                    match operation {
                        Operation::Sine(_) => pending.push(number + 1),
                        Operation::Cosine(_) => pending.extend(number.checked_sub(1)),
                        _ => {}
                    }
                }
            }
        }
        let is_leaf = |node: &Node| matches!(node.operation, Operation::Leaf(_));
        let varying = nodes.iter().enumerate();
        let varying = varying.filter(|(_, node)| node.used && !node.constant && !is_leaf(node));
        let varying = varying.map(|(number, _)| number).collect();
        let mut leaves = Vec::new();
        for (number, node) in nodes.iter().enumerate() {
            if let Operation::Leaf(leaf) = node.operation {
                if leaves.len() <= leaf {
                    leaves.resize(leaf + 1, None);
                }
                if let Some(slot) = leaves.get_mut(leaf) {
                    *slot = Some(number);
                }
            }
        }
        Self {
            series: vec![[0.0; LENGTH]; nodes.len()],
            adjoints: vec![NO_ADJOINT; nodes.len()],
            nodes,
            varying,
            leaves,
            rates,
            edges,
            seed: 0,
        }
    }

    fn leaf_node(&self, leaf: usize) -> Option<usize> {
        self.leaves.get(leaf).copied().flatten()
    }

    /// Sets the lowest coefficients of a leaf's series and clears the rest.
    pub(crate) fn set_leaf(&mut self, leaf: usize, value: f64, slope: f64) {
        if let Some(series) = self.leaf_node(leaf).and_then(|node| self.series.get_mut(node)) {
            *series = [0.0; LENGTH];
            let [first, second, ..] = series;
            (*first, *second) = (value, slope);
        }
    }

    /// Sets one coefficient of a state variable.
    #[inline]
    pub(crate) fn set_state(&mut self, variable: usize, degree: usize, value: f64) {
        let series = self.leaf_node(STATE + variable).and_then(|node| self.series.get_mut(node));
        if let Some(coefficient) = series.and_then(|series| series.get_mut(degree)) {
            *coefficient = value;
        }
    }

    /// Computes what depends on parameters only. The leaves of the parameters have to be set.
    pub(crate) fn prepare(&mut self) {
        for number in 0..self.nodes.len() {
            let constant = self.nodes.get(number).is_some_and(|node| node.constant);
            if constant {
                self.evaluate(number, 0);
            }
        }
    }

    /// Computes coefficient `degree` of every node, from lower ones and those of the leaves.
    #[inline]
    pub(crate) fn extend(&mut self, degree: usize) {
        for index in 0..self.varying.len() {
            if let Some(&number) = self.varying.get(index) {
                self.evaluate(number, degree);
            }
        }
    }

    /// A node's series.
    #[inline]
    pub(crate) fn series(&self, number: usize) -> &Series {
        const ZERO: &Series = &[0.0; LENGTH];
        self.series.get(number).unwrap_or(ZERO)
    }

    /// One coefficient of a node's series.
    #[inline]
    pub(crate) fn coefficient(&self, number: usize, degree: usize) -> f64 {
        self.series(number).get(degree).copied().unwrap_or(0.0)
    }

    /// The state variable that a node simply is, if so.
    pub(crate) fn link(&self, number: usize) -> Option<usize> {
        match self.nodes.get(number)?.operation {
            Operation::Leaf(leaf) if (STATE..INPUT).contains(&leaf) => Some(leaf - STATE),
            _ => None,
        }
    }

    fn is_constant(&self, number: usize) -> bool {
        self.nodes.get(number).is_some_and(|node| node.constant)
    }

    fn evaluate(&mut self, number: usize, degree: usize) {
        let Some(node) = self.nodes.get(number) else { return };
        let of = |operand: usize| self.series(operand);
        let at = |operand: usize| of(operand).get(degree).copied().unwrap_or(0.0);
        let value = match node.operation {
            Operation::Leaf(_) => return,
            Operation::Add(a, b) => at(a) + at(b),
            Operation::Subtract(a, b) => at(a) - at(b),
            Operation::Scale(a, factor) => at(a) * factor,
            Operation::Offset(a, summand) => {
                if degree == 0 {
                    at(a) + summand
                } else {
                    at(a)
                }
            }
            Operation::Multiply(a, b) if self.is_constant(a) => first(of(a)) * at(b),
            Operation::Multiply(a, b) if self.is_constant(b) => at(a) * first(of(b)),
            Operation::Multiply(a, b) => convolve(of(a), of(b), degree),
            Operation::Divide(a, b) if self.is_constant(b) => at(a) / first(of(b)),
            Operation::Divide(a, b) => {
                // a = q·b: everything but q_degree·b₀ is known.
                let quotient = of(number).iter().take(degree);
                let divisor = of(b).get(1..=degree).unwrap_or_default().iter().rev();
                let known: f64 = quotient.zip(divisor).map(|(q, b)| q * b).sum();
                (at(a) - known) / first(of(b))
            }
            Operation::Sine(a) if degree == 0 => first(of(a)).sin(),
            Operation::Cosine(a) if degree == 0 => first(of(a)).cos(),
            Operation::Exponential(a) if degree == 0 => first(of(a)).exp(),
            Operation::Sine(a) => weighted(of(a), of(number + 1), degree),
            Operation::Cosine(a) => -weighted(of(a), of(number.saturating_sub(1)), degree),
            Operation::Exponential(a) => weighted(of(a), of(number), degree),
        };
        if let Some(slot) = self.series.get_mut(number).and_then(|series| series.get_mut(degree)) {
            *slot = value;
        }
    }

    /// Derivative series of a node with respect to every other, up to and with `degree`: one backward sweep.
    ///
    /// # Reference
    /// Griewank, Walther, Evaluating Derivatives, 2nd ed., SIAM 2008, sections 3.2 and 13.
    pub(crate) fn differentiate(&mut self, output: usize, degree: usize) {
        let count = degree + 1;
        for adjoint in self.adjoints.iter_mut().take(self.seed.max(output) + 1) {
            adjoint.length = 0;
        }
        self.seed = output;
        if let Some(adjoint) = self.adjoints.get_mut(output) {
            *adjoint = NO_ADJOINT;
            adjoint.length = 1;
            let [first, ..] = &mut adjoint.series;
            *first = 1.0;
        }
        for number in (0..=output).rev() {
            let (Some(node), Some(adjoint)) = (self.nodes.get(number), self.adjoints.get(number)) else {
                continue;
            };
            if adjoint.length == 0 || !node.wanted {
                continue;
            }
            let (operation, adjoint) = (node.operation, *adjoint);
            match operation {
                Operation::Leaf(_) => {}
                Operation::Add(a, b) => {
                    self.pass(a, &adjoint, 1.0);
                    self.pass(b, &adjoint, 1.0);
                }
                Operation::Subtract(a, b) => {
                    self.pass(a, &adjoint, 1.0);
                    self.pass(b, &adjoint, -1.0);
                }
                Operation::Scale(a, factor) => self.pass(a, &adjoint, factor),
                Operation::Offset(a, _) => self.pass(a, &adjoint, 1.0),
                Operation::Multiply(a, b) => {
                    self.pass_product(a, &adjoint, b, 1.0, count);
                    self.pass_product(b, &adjoint, a, 1.0, count);
                }
                Operation::Divide(a, b) => {
                    let divided = self.divided(&adjoint, b, count);
                    self.pass(a, &divided, 1.0);
                    self.pass_product(b, &divided, number, -1.0, count);
                }
                Operation::Sine(a) => self.pass_product(a, &adjoint, number + 1, 1.0, count),
                Operation::Cosine(a) => {
                    self.pass_product(a, &adjoint, number.saturating_sub(1), -1.0, count);
                }
                Operation::Exponential(a) => self.pass_product(a, &adjoint, number, 1.0, count),
            }
        }
    }

    /// The derivative series with respect to a leaf, as far as it is not zero.
    pub(crate) fn derivative(&self, leaf: usize) -> &[f64] {
        let adjoint = self.leaf_node(leaf).and_then(|node| self.adjoints.get(node));
        adjoint.and_then(|adjoint| adjoint.series.get(..adjoint.length)).unwrap_or_default()
    }

    fn target(&mut self, operand: usize) -> Option<&mut Adjoint> {
        let wanted = self.nodes.get(operand).is_some_and(|node| node.wanted);
        self.adjoints.get_mut(operand).filter(|_| wanted)
    }

    /// Adds a multiple of an adjoint to an operand's.
    fn pass(&mut self, operand: usize, adjoint: &Adjoint, factor: f64) {
        let Some(target) = self.target(operand) else { return };
        target.grow(adjoint.length);
        for (target, value) in target.series.iter_mut().zip(adjoint.series).take(adjoint.length) {
            *target += factor * value;
        }
    }

    /// Adds the product of an adjoint and another node's series to an operand's adjoint.
    fn pass_product(&mut self, operand: usize, adjoint: &Adjoint, by: usize, factor: f64, count: usize) {
        let constant = self.is_constant(by);
        let Some(series) = self.series.get(by).copied() else { return };
        if constant {
            return self.pass(operand, adjoint, factor * first(&series));
        }
        let Some(target) = self.target(operand) else { return };
        target.grow(count);
        if adjoint.length == 1 {
            let factor = factor * first(&adjoint.series);
            for (target, value) in target.series.iter_mut().zip(series).take(count) {
                *target += factor * value;
            }
            return;
        }
        for (degree, target) in target.series.iter_mut().enumerate().take(count) {
            *target += factor * convolve(&adjoint.series, &series, degree);
        }
    }

    /// An adjoint divided by a node's series.
    fn divided(&self, adjoint: &Adjoint, by: usize, count: usize) -> Adjoint {
        let series = self.series(by);
        let constant = self.is_constant(by);
        let mut quotient = *adjoint;
        if constant {
            quotient.series = quotient.series.map(|value| value / first(series));
            return quotient;
        }
        quotient.length = count;
        for degree in 0..count {
            let divisor = series.get(1..=degree).unwrap_or_default().iter().rev();
            let known: f64 = quotient.series.iter().zip(divisor).map(|(q, b)| q * b).sum();
            if let Some(slot) = quotient.series.get_mut(degree) {
                *slot = (*slot - known) / first(series);
            }
        }
        quotient
    }
}

impl Adjoint {
    /// Makes room for coefficients below `length`: those not in use yet become zero.
    fn grow(&mut self, length: usize) {
        for value in self.series.iter_mut().take(length).skip(self.length) {
            *value = 0.0;
        }
        self.length = self.length.max(length);
        // A later product reads all coefficients of a degree, so that none may be stale.
        for value in self.series.iter_mut().skip(self.length) {
            *value = 0.0;
        }
    }
}

fn operands(operation: Operation) -> (usize, Option<usize>) {
    match operation {
        Operation::Add(a, b)
        | Operation::Subtract(a, b)
        | Operation::Multiply(a, b)
        | Operation::Divide(a, b) => (a, Some(b)),
        Operation::Leaf(a)
        | Operation::Scale(a, _)
        | Operation::Offset(a, _)
        | Operation::Sine(a)
        | Operation::Cosine(a)
        | Operation::Exponential(a) => (a, None),
    }
}

fn first(series: &Series) -> f64 {
    let [first, ..] = series;
    *first
}

/// Coefficient `degree` of a product.
#[inline]
fn convolve(a: &Series, b: &Series, degree: usize) -> f64 {
    let reversed = b.get(..=degree).unwrap_or_default().iter().rev();
    a.iter().zip(reversed).map(|(a, b)| a * b).sum()
}

/// Coefficient `degree` ≥ 1 of g with g′ = f·a′: (1/d)·Σ j·a_j·f_{d−j}.
#[inline]
fn weighted(a: &Series, f: &Series, degree: usize) -> f64 {
    let reversed = f.get(..degree).unwrap_or_default().iter().rev();
    let terms = a.iter().zip(1..).skip(1).zip(reversed);
    terms.map(|((a, j), f)| f64::from(j - 1) * a * f).sum::<f64>() / degree as f64
}

/// The value of a series at a time after the step began.
#[inline]
pub(crate) fn value(series: &[f64], time: f64) -> f64 {
    series.iter().rev().fold(0.0, |sum, coefficient| sum * time + coefficient)
}
