//! Recorded field: the graph of its operations.

#![allow(clippy::indexing_slicing, reason = "no degree exceeds the length of a series")]

use super::expression::{Expression, Operation, Recorder};
use super::node::Node;
use super::program::Program;
use super::series::{Adjoint, LENGTH, Series, first};
use crate::edges::Edge;
use crate::field::{Field, Mode, SYSTEM_HIDDEN, State, Term};
use crate::law::MOST_PARAMETERS;
use crate::nominal::Coefficients;

/// Numbers of the leaves: time, state, raw input and its rate, nominal coefficients, then [`MOST_PARAMETERS`] for each
/// effect.
pub(crate) const TIME: usize = 0;
/// Leaf of the position, followed by velocity and hidden state.
pub(crate) const STATE: usize = 1;
/// Maximum number of state variables of a system.
pub(crate) const MOST_STATES: usize = 2 + SYSTEM_HIDDEN;
/// Leaf of the input before the gain.
pub(crate) const INPUT: usize = STATE + MOST_STATES;
/// Leaf of the input's rate before the gain.
pub(crate) const INPUT_RATE: usize = INPUT + 1;
/// Leaf of the inertia, followed by damping, stiffness, rest angle and input gain.
pub(crate) const NOMINAL: usize = INPUT_RATE + 1;
/// Leaf of the first effect's first parameter.
pub(crate) const EFFECTS: usize = NOMINAL + 5;

/// Recorded field of one mode: rates of the state and margins of the edges.
#[derive(Debug, Clone)]
pub(crate) struct Graph {
    pub(super) nodes: Vec<Node>,
    program: Program,
    /// Node of each leaf.
    leaves: Vec<Option<usize>>,
    /// Node of each state variable's rate.
    pub(crate) rates: Vec<usize>,
    pub(crate) edges: Vec<(Edge, usize)>,
    pub(super) series: Vec<Series>,
    pub(super) adjoints: Vec<Adjoint>,
}

impl Graph {
    /// Records the field of a mode. `free` selects the leaves whose derivatives are needed, besides the
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
            input: [nominal.input_gain * leaf(INPUT), nominal.input_gain * leaf(INPUT_RATE)],
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
        let mut nodes = nodes(operations, |leaf| (STATE..STATE + states).contains(&leaf) || free(leaf));
        let results = || rates.iter().copied().chain(edges.iter().map(|edge| edge.1));
        mark_used(&mut nodes, results());
        keep(&mut nodes, results());
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
            adjoints: vec![Adjoint::NONE; nodes.len()],
            nodes,
            program: Program::default(),
            leaves,
            rates,
            edges,
        }
    }

    pub(super) fn leaf_node(&self, leaf: usize) -> Option<usize> {
        self.leaves.get(leaf).copied().flatten()
    }

    /// Sets the lowest coefficients of a leaf's series and clears the rest.
    pub(crate) fn set_leaf(&mut self, leaf: usize, lowest: &[f64]) {
        if let Some(series) = self.leaf_node(leaf).and_then(|node| self.series.get_mut(node)) {
            *series = [0.0; LENGTH];
            for (slot, value) in series.iter_mut().zip(lowest) {
                *slot = *value;
            }
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

    /// Computes everything that depends on parameters only, and compiles the program for the rest. The leaves
    /// of the parameters have to be set before.
    pub(crate) fn prepare(&mut self) {
        for (number, node) in self.nodes.iter().enumerate().filter(|(_, node)| node.constant) {
            let of = |operand: usize| first(self.series(operand));
            let value = match node.operation {
                Operation::Leaf(_) => continue,
                Operation::Add(a, b) => of(a) + of(b),
                Operation::Subtract(a, b) => of(a) - of(b),
                Operation::Multiply(a, b) => of(a) * of(b),
                Operation::Divide(a, b) => of(a) / of(b),
                Operation::Scale(a, factor) => of(a) * factor,
                Operation::Offset(a, summand) => of(a) + summand,
                Operation::Sine(a) => libm::sin(of(a)),
                Operation::Cosine(a) => libm::cos(of(a)),
                Operation::Exponential(a) => libm::exp(of(a)),
            };
            if let Some([slot, ..]) = self.series.get_mut(number) {
                *slot = value;
            }
        }
        self.program = Program::compile(&self.nodes, &self.series);
    }

    /// Computes coefficient `degree` of every node that is needed, from lower ones and those of the leaves.
    #[inline]
    pub(crate) fn extend(&mut self, degree: usize) {
        self.program.extend(&mut self.series, degree);
    }

    /// Returns a node's series.
    #[inline]
    pub(crate) fn series(&self, number: usize) -> &Series {
        const ZERO: &Series = &[0.0; LENGTH];
        debug_assert!(number < self.series.len(), "node {number} of {}", self.series.len());
        self.series.get(number).unwrap_or(ZERO)
    }

    /// Returns one coefficient of a node's series.
    #[inline]
    pub(crate) fn coefficient(&self, number: usize, degree: usize) -> f64 {
        debug_assert!(degree < LENGTH, "coefficient {degree} of {LENGTH}");
        self.series(number)[degree.min(LENGTH - 1)]
    }

    /// Returns the state variable that a node is identical to; `None` if it is another expression.
    pub(crate) fn link(&self, number: usize) -> Option<usize> {
        match self.nodes.get(number)?.operation {
            Operation::Leaf(leaf) if (STATE..INPUT).contains(&leaf) => Some(leaf - STATE),
            _ => None,
        }
    }
}

/// Creates the nodes of operations, each marked if it depends on parameters only, and if it depends on a leaf
/// whose derivatives are needed.
fn nodes(operations: Vec<Operation>, wanted: impl Fn(usize) -> bool) -> Vec<Node> {
    let mut nodes: Vec<Node> = Vec::with_capacity(operations.len());
    for operation in operations {
        let (constant, wanted) = match operation {
            Operation::Leaf(leaf) => (leaf >= NOMINAL, wanted(leaf)),
            other => {
                let of = |number: usize| nodes.get(number).map_or((true, false), |n| (n.constant, n.wanted));
                let (first, second) = operands(other);
                debug_assert!(first < nodes.len() && second.is_none_or(|second| second < nodes.len()));
                let (first, second) = (of(first), second.map_or((true, false), of));
                (first.0 && second.0, first.1 || second.1)
            }
        };
        nodes.push(Node { operation, constant, wanted, used: false, kept: false });
    }
    nodes
}

/// Marks the nodes that results depend on.
fn mark_used(nodes: &mut [Node], results: impl Iterator<Item = usize>) {
    let mut pending: Vec<usize> = results.collect();
    while let Some(number) = pending.pop() {
        let Some(node) = nodes.get_mut(number).filter(|node| !node.used) else { continue };
        node.used = true;
        let operation = node.operation;
        if matches!(operation, Operation::Leaf(_)) {
            continue;
        }
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

/// Marks the nodes whose own series are needed.
fn keep(nodes: &mut [Node], results: impl Iterator<Item = usize>) {
    let mut kept: Vec<usize> = results.collect();
    let of = |number: usize| nodes.get(number).map_or((true, false), |node| (node.constant, node.wanted));
    for (number, node) in nodes.iter().enumerate().filter(|(_, node)| node.used && !node.constant) {
        match node.operation {
            Operation::Multiply(a, b) => {
                // With a constant factor the product is linear, but the factor's derivative is the other's
                // series.
                let ((a_constant, a_wanted), (b_constant, b_wanted)) = (of(a), of(b));
                if (a_constant && a_wanted) || !(a_constant || b_constant) {
                    kept.push(b);
                }
                if (b_constant && b_wanted) || !(a_constant || b_constant) {
                    kept.push(a);
                }
            }
            Operation::Divide(a, b) => {
                let (constant, wanted) = of(b);
                kept.extend([a, b].into_iter().filter(|_| !constant));
                kept.extend([number].into_iter().filter(|_| wanted));
            }
            Operation::Sine(a) | Operation::Cosine(a) | Operation::Exponential(a) => kept.push(a),
            Operation::Leaf(_)
            | Operation::Add(..)
            | Operation::Subtract(..)
            | Operation::Scale(..)
            | Operation::Offset(..) => {}
        }
    }
    for number in kept {
        if let Some(node) = nodes.get_mut(number) {
            node.kept = true;
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
