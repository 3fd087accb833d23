//! Condensed program of a graph's operations.

#![allow(
    clippy::indexing_slicing,
    reason = "instructions name nodes of the graph that they were compiled from"
)]

use super::expression::Operation;
use super::node::Node;
use super::series::{LENGTH, Series, convolve, dot_reversed, head};

/// Instructions that compute one coefficient of every series. A chain of sums and of products with constants
/// is condensed into one linear combination.
#[derive(Debug, Clone, Default)]
pub(crate) struct Program {
    instructions: Vec<Instruction>,
    /// Nodes and their factors, for the linear combinations.
    terms: Vec<(usize, f64)>,
}

#[derive(Debug, Clone, Copy)]
enum Instruction {
    /// Sum of terms, with an offset to the lowest coefficient.
    Linear {
        target: usize,
        from: usize,
        until: usize,
        offset: f64,
    },
    Product {
        target: usize,
        a: usize,
        b: usize,
    },
    Quotient {
        target: usize,
        a: usize,
        b: usize,
    },
    Circular {
        sine: usize,
        cosine: usize,
        a: usize,
    },
    Exponential {
        target: usize,
        a: usize,
    },
}

/// Linear combination of nodes whose series are kept.
#[derive(Debug, Clone, Default)]
struct Form {
    offset: f64,
    terms: Vec<(usize, f64)>,
}

impl Form {
    fn of(number: usize) -> Self {
        Self { offset: 0.0, terms: vec![(number, 1.0)] }
    }

    fn times(mut self, factor: f64) -> Self {
        self.offset *= factor;
        for (_, own) in &mut self.terms {
            *own *= factor;
        }
        self.terms.retain(|(_, factor)| *factor != 0.0);
        self
    }

    fn plus(mut self, other: &Self, factor: f64) -> Self {
        self.offset += factor * other.offset;
        for &(number, own) in &other.terms {
            match self.terms.iter_mut().find(|(known, _)| *known == number) {
                Some((_, known)) => *known += factor * own,
                None => self.terms.push((number, factor * own)),
            }
        }
        self
    }
}

impl Program {
    /// Condenses a graph whose constant nodes have their values in `series`.
    pub(crate) fn compile(nodes: &[Node], series: &[Series]) -> Self {
        let mut program = Self::default();
        let mut forms: Vec<Form> = Vec::with_capacity(nodes.len());
        for (number, node) in nodes.iter().enumerate() {
            let form = if node.constant {
                Form { offset: coefficient(series, number, 0), terms: Vec::new() }
            } else if node.varies() {
                program.condense(number, node, nodes, &forms)
            } else {
                Form::default()
            };
            forms.push(form);
        }
        program
    }

    fn condense(&mut self, number: usize, node: &Node, nodes: &[Node], forms: &[Form]) -> Form {
        debug_assert!(forms.len() == number, "operands come before what they are needed for");
        let of = |operand: usize| forms[operand].clone();
        let constant = |operand: usize| nodes.get(operand).is_some_and(|node| node.constant);
        let form = match node.operation {
            Operation::Leaf(_) => return Form::of(number),
            Operation::Add(a, b) => of(a).plus(&of(b), 1.0),
            Operation::Subtract(a, b) => of(a).plus(&of(b), -1.0),
            Operation::Scale(a, factor) => of(a).times(factor),
            Operation::Offset(a, summand) => {
                let mut form = of(a);
                form.offset += summand;
                form
            }
            Operation::Multiply(a, b) if constant(a) => of(b).times(of(a).offset),
            Operation::Multiply(a, b) if constant(b) => of(a).times(of(b).offset),
            Operation::Divide(a, b) if constant(b) => of(a).times(1.0 / of(b).offset),
            Operation::Multiply(a, b) => {
                return self.nonlinear(number, Instruction::Product { target: number, a, b });
            }
            Operation::Divide(a, b) => {
                return self.nonlinear(number, Instruction::Quotient { target: number, a, b });
            }
            Operation::Sine(a) => {
                return self.nonlinear(number, Instruction::Circular { sine: number, cosine: number + 1, a });
            }
            // Computed with its sine, the node before.
            Operation::Cosine(_) => return Form::of(number),
            Operation::Exponential(a) => {
                return self.nonlinear(number, Instruction::Exponential { target: number, a });
            }
        };
        if !node.is_kept() {
            return form;
        }
        let from = self.terms.len();
        self.terms.extend(&form.terms);
        let until = self.terms.len();
        self.nonlinear(number, Instruction::Linear { target: number, from, until, offset: form.offset })
    }

    /// Adds a node with a series of its own.
    fn nonlinear(&mut self, number: usize, instruction: Instruction) -> Form {
        self.instructions.push(instruction);
        Form::of(number)
    }

    /// Computes one coefficient of every series, from lower ones and those of the leaves.
    #[inline]
    pub(crate) fn extend(&self, series: &mut [Series], degree: usize) {
        for instruction in &self.instructions {
            match *instruction {
                Instruction::Linear { target, from, until, offset } => {
                    let terms = &self.terms[from..until];
                    let start = if degree == 0 { offset } else { 0.0 };
                    let sum = terms.iter().fold(start, |sum, &(number, factor)| {
                        sum + factor * coefficient(series, number, degree)
                    });
                    put(series, target, degree, sum);
                }
                Instruction::Product { target, a, b } => {
                    let Some((a, b)) = pair(series, a, b) else { continue };
                    let value = convolve(a, b, degree);
                    put(series, target, degree, value);
                }
                Instruction::Quotient { target, a, b } => {
                    // a = q·b: everything but q_degree·b₀ is known.
                    let Some((quotient, [_, divisor @ ..])) = pair(series, target, b) else { continue };
                    let known = dot_reversed(head(quotient, degree), head(divisor, degree));
                    let value = (coefficient(series, a, degree) - known) / coefficient(series, b, 0);
                    put(series, target, degree, value);
                }
                Instruction::Circular { sine, cosine, a } => {
                    let (first, second) = if degree == 0 {
                        libm::sincos(coefficient(series, a, 0))
                    } else {
                        (weighted(series, a, cosine, degree), -weighted(series, a, sine, degree))
                    };
                    put(series, sine, degree, first);
                    put(series, cosine, degree, second);
                }
                Instruction::Exponential { target, a } => {
                    let value = if degree == 0 {
                        libm::exp(coefficient(series, a, 0))
                    } else {
                        weighted(series, a, target, degree)
                    };
                    put(series, target, degree, value);
                }
            }
        }
    }
}

// These functions are called for every coefficient. With indices that may panic, runs took 7 % longer.

#[inline]
fn coefficient(series: &[Series], number: usize, degree: usize) -> f64 {
    debug_assert!(number < series.len() && degree < LENGTH, "coefficient {degree} of node {number}");
    series.get(number).and_then(|series| series.get(degree)).copied().unwrap_or(0.0)
}

#[inline]
fn pair(series: &[Series], a: usize, b: usize) -> Option<(&Series, &Series)> {
    debug_assert!(a.max(b) < series.len(), "nodes {a} and {b} of {}", series.len());
    Some((series.get(a)?, series.get(b)?))
}

#[inline]
fn put(series: &mut [Series], number: usize, degree: usize, value: f64) {
    if let Some(slot) = series.get_mut(number).and_then(|series| series.get_mut(degree)) {
        *slot = value;
    }
}

/// Computes coefficient `degree` ≥ 1 of g with g′ = f·a′: (1/d)·Σ j·a_j·f_{d−j}.
#[inline]
fn weighted(series: &[Series], a: usize, f: usize, degree: usize) -> f64 {
    let Some((a, f)) = pair(series, a, f) else { return 0.0 };
    let reversed = head(f, degree).iter().rev();
    let terms = a.iter().zip(1_u32..).skip(1).zip(reversed);
    terms.map(|((a, j), f)| f64::from(j - 1) * a * f).sum::<f64>() / degree as f64
}
