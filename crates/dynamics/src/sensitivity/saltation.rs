//! Passage to the next piece: the jump of the columns at an event.

use super::free::Place;
use super::graph::{INPUT, INPUT_RATE, STATE, TIME};
use super::march::March;
use super::model::Model;
use crate::edges::Edge;

impl March<'_> {
    /// Passes to the piece behind an edge; the columns jump where the force does.
    pub(super) fn cross(&mut self, edge: Edge, number: usize) {
        self.response.events += 1;
        let [_, velocity, ..] = &mut self.state;
        let at_rest = *velocity == 0.0;
        if edge == Edge::Reversal {
            *velocity = 0.0;
        }
        let before = self.rates();
        let old = self.mode;
        self.mode = self.model.field.behind(&self.point(), &old, edge);
        if edge == Edge::Reversal
            && at_rest
            && self.mode.direction == old.direction
            && self.model.field.holding_torque(&self.point(), &old).is_none()
        {
            // At rest in balance the torque does not show the direction of the further motion; the series does.
            self.mode = self.model.field.moving(&self.point(), -old.direction);
        }
        let after = self.rates();
        let [_, _, hidden @ ..] = &mut self.state;
        self.model.field.settle(&self.mode, hidden);
        let rates = before.iter().zip(&after);
        let jumps = rates
            .into_iter()
            .any(|(before, after)| (before - after).abs() > 1e-12 * before.abs().max(after.abs()));
        if jumps && !self.model.free.is_empty() {
            self.shift(edge, number);
            debug_assert_eq!(self.model.shifts.len(), self.model.free.len(), "one shift for each column");
            for (column, &shift) in self.model.shifts.iter().enumerate() {
                for (variable, (before, after)) in before.iter().zip(after).enumerate().skip(1) {
                    if let Some(slot) = self.model.columns.first_mut(column, variable) {
                        *slot += (before - after) * shift;
                    }
                }
            }
        }
        if self.mode.sticks() {
            for column in 0..self.model.free.len() {
                if let Some(slot) = self.model.columns.first_mut(column, 1) {
                    *slot = 0.0;
                }
            }
        }
    }

    /// Computes by how much each free quantity delays the event: −δm/ṁ with the margin m of the edge.
    fn shift(&mut self, edge: Edge, number: usize) {
        let point = self.point();
        let [raw, raw_rate] = self.drive.raw(self.time);
        let ([_, slope, ..], [_, curvature, ..]) = (raw, raw_rate);
        let Model { graphs, states, free, columns, shifts, .. } = &mut *self.model;
        let Some(piece) = graphs.get_mut(number) else { return };
        let graph = &mut piece.graph;
        let Some(&(_, node)) = graph.edges.iter().find(|(other, _)| *other == edge) else { return };
        graph.set_leaf(TIME, &[point.time, 1.0]);
        graph.set_leaf(INPUT, &raw);
        graph.set_leaf(INPUT_RATE, &raw_rate);
        for (variable, &value) in self.state.iter().enumerate().take(*states) {
            graph.set_leaf(STATE + variable, &[value]);
        }
        graph.extend(0);
        debug_assert_eq!(graph.rates.len(), *states, "a rate for each state variable");
        for variable in 0..*states {
            let Some(&node) = graph.rates.get(variable) else { continue };
            graph.set_state(variable, 1, graph.coefficient(node, 0));
        }
        graph.extend(1);
        let speed = graph.coefficient(node, 1);
        graph.differentiate(node, 0);
        // The series of a derivative with respect to a leaf that a margin does not depend on is empty.
        let partial = |leaf: usize| graph.derivative(leaf).first().copied().unwrap_or(0.0);
        for (column, (shift, place)) in shifts.iter_mut().zip(free.iter()).enumerate() {
            let mut moved: f64 =
                (0..*states).map(|state| partial(STATE + state) * columns.first(column, state)).sum();
            moved += match *place {
                Place::Leaf(leaf) => partial(leaf),
                Place::Delay(_) => -slope * partial(INPUT) - curvature * partial(INPUT_RATE),
                Place::Start(_) => 0.0,
            };
            // An edge that is only touched has no side to be shifted to.
            *shift = if speed == 0.0 { 0.0 } else { -moved / speed };
        }
    }
}
