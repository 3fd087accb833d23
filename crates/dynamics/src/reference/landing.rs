//! Detection of the edge that a step meets, and landing of the step on it.

use super::run::{Landing, MOST_ITERATIONS, Run};
use super::step::{Solved, Step, Vector, state};
use crate::edges::Edge;

/// Part of a step over which a margin's slope is taken. Its cube is far below the effect of a visit behind an
/// edge.
const SLOPE: f64 = 1e-5;

/// Part of a step, and the margin of an edge there.
#[derive(Debug, Clone, Copy)]
struct Look {
    tau: f64,
    margin: f64,
}

impl Run<'_> {
    /// Returns the edge that the step meets first, and the part of the step at which its polynomial meets it.
    pub(super) fn first_edge(&self, step: &Step) -> Option<(Edge, f64)> {
        let edges = self.looks(step);
        let met = edges.iter().filter_map(|(edge, looks)| Some((*edge, self.meeting(step, *edge, looks)?)));
        met.reduce(|first, other| if other.1 < first.1 { other } else { first })
    }

    /// Returns the margins of every edge at the start, the nodes and the end of a step.
    fn looks(&self, step: &Step) -> Vec<(Edge, Vec<Look>)> {
        let mut edges: Vec<(Edge, Vec<Look>)> = Vec::new();
        let begin = state(step.from, &step.begin, self.drive.torque(step.from));
        self.field.edges(self.directed, &begin, &self.mode, |edge, margin| {
            edges.push((edge, vec![Look { tau: 0.0, margin }]));
        });
        if edges.is_empty() {
            return edges;
        }
        let stages = self.gauss.nodes.iter().copied().zip(step.stages.iter().copied());
        for (tau, vector) in stages.chain([(1.0, step.at(1.0))]) {
            let mut number = 0;
            self.visit(step, tau, &vector, |_, margin| {
                if let Some((_, looks)) = edges.get_mut(number) {
                    looks.push(Look { tau, margin });
                }
                number += 1;
            });
        }
        edges
    }

    fn visit(&self, step: &Step, tau: f64, vector: &Vector, visit: impl FnMut(Edge, f64)) {
        let time = step.from + tau * step.size;
        let state = state(time, vector, self.drive.torque(time));
        self.field.edges(self.directed, &state, &self.mode, visit);
    }

    /// Returns the part of a step at which the polynomial first meets one edge.
    fn meeting(&self, step: &Step, edge: Edge, looks: &[Look]) -> Option<f64> {
        let mut before: Option<Look> = None;
        for (number, pair) in looks.windows(2).enumerate() {
            let &[last, look] = pair else { continue };
            if look.margin < 0.0 {
                match (edge, last.margin > 0.0) {
                    (_, true) => return Some(self.root(step, edge, last.tau, look.tau)),
                    // A reversal counts only once the body has started to move.
                    (Edge::Reversal, false) => {}
                    (_, false) => return Some(last.tau),
                }
            } else {
                // The margin may be negative for a short time between two evaluations.
                let falls = before.is_none_or(|before| before.margin > last.margin);
                let rises = looks.get(number + 2).is_none_or(|next| next.margin > look.margin);
                if last.margin > 0.0
                    && falls
                    && rises
                    && let Some(met) = self.visit_between(step, edge, last.tau, look.tau)
                {
                    return Some(met);
                }
            }
            before = Some(last);
        }
        None
    }

    /// Finds the first zero of a margin that is positive at both ends of a part of the step but negative in
    /// between.
    fn visit_between(&self, step: &Step, edge: Edge, from: f64, to: f64) -> Option<f64> {
        let slope = |tau: f64| self.margin(step, edge, tau + SLOPE) - self.margin(step, edge, tau - SLOPE);
        if !(slope(from) < 0.0 && slope(to) > 0.0) {
            return None;
        }
        let lowest = crate::root::bracketed(from, to, |tau| -slope(tau));
        (self.margin(step, edge, lowest) < 0.0).then(|| self.root(step, edge, from, lowest))
    }

    fn margin(&self, step: &Step, edge: Edge, tau: f64) -> f64 {
        let time = step.from + tau * step.size;
        let state = state(time, &step.at(tau), self.drive.torque(time));
        self.field.distance(self.directed, &state, &self.mode, edge).unwrap_or(f64::INFINITY)
    }

    /// Finds the zero of a margin on the polynomial, between a point where it is positive and one where it is
    /// negative.
    fn root(&self, step: &Step, edge: Edge, from: f64, to: f64) -> f64 {
        crate::root::bracketed(from, to, |tau| self.margin(step, edge, tau))
    }

    /// Solves the step again so that it ends on the edge.
    pub(super) fn land(&self, step: &mut Step, edge: Edge, tau: f64) -> Landing {
        let mut size = tau * step.size;
        let resolution = f64::EPSILON * step.from.abs().max(size);
        if size <= resolution {
            return Landing::AtOnce;
        }
        let scale = self.scale_with(size);
        for _ in 0..4 {
            step.size = size;
            // Twice the iterations: this must suffice for a step that converged with a slightly greater
            // length.
            let iterations = 2 * MOST_ITERATIONS;
            let solved = step.solve(&self.gauss, &self.field, &self.mode, &self.drive, &scale, iterations);
            if matches!(solved, Solved::TooLarge) {
                return Landing::Failed;
            }
            let (inner, outer) = (self.margin(step, edge, 0.999), self.margin(step, edge, 1.0));
            let slope = (outer - inner) / (0.001 * size);
            let correction = -outer / slope;
            if !correction.is_finite() || correction.abs() > 0.01 * size || correction.abs() <= resolution {
                break;
            }
            size += correction;
        }
        Landing::OnTheEdge
    }
}
