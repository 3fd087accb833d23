//! The edge that a step by Taylor series meets first.

use super::march::March;
use super::series::{LENGTH, Series, slope, value};
use crate::edges::Edge;
use crate::system::BALANCE;

/// Parts of a step at which the sign of a margin is looked at.
const LOOKS: u32 = 8;

/// A coefficient of a margin this small, relative to all, is rounding: the step begins on the edge.
const ON_THE_EDGE: f64 = 1e-12;

impl March<'_> {
    /// The edge that the step meets first, and when after its beginning.
    pub(super) fn first_edge(&self, number: usize, degree: usize, size: f64) -> Option<(Edge, f64)> {
        let piece = self.model.graphs.get(number)?;
        let mut first: Option<(Edge, f64)> = None;
        let [_, velocity, ..] = self.state;
        let field = &self.model.field;
        let balance = BALANCE * field.holding_torque().unwrap_or(0.0) / field.nominal.inertia;
        for &(edge, node) in &piece.graph.edges {
            let margin = piece.graph.series(node).get(..=degree).unwrap_or_default();
            let until = first.map_or(size, |(_, time)| time);
            let mut balanced: Series = [0.0; LENGTH];
            let margin = if edge == Edge::Reversal && velocity == 0.0 {
                // Just broken away: what the torque exceeds the hold by is rounding, how it goes on is not.
                for (slot, coefficient) in balanced.iter_mut().zip(margin) {
                    *slot = *coefficient;
                }
                let [_, acceleration, ..] = &mut balanced;
                if acceleration.abs() <= balance {
                    *acceleration = 0.0;
                }
                balanced.get(..=degree).unwrap_or_default()
            } else {
                margin
            };
            if let Some(time) = crossing(margin, until, 4.0 * f64::EPSILON * self.time.abs()) {
                first = Some((edge, time));
            }
        }
        first
    }
}

/// When a margin, positive now, first becomes negative within a time; 0 where it is about to. `resolution` is
/// how exactly the present time is known.
fn crossing(margin: &[f64], until: f64, resolution: f64) -> Option<f64> {
    let mut power = 1.0;
    let mut total = 0.0;
    for coefficient in margin {
        total += coefficient.abs() * power;
        power *= until;
    }
    let (first, rest) = margin.split_first()?;
    // The rest cannot outweigh the first.
    if *first > total - first.abs() {
        return None;
    }
    // On the edge itself the lowest coefficients are rounding; what counts is how the margin goes on.
    let (mut lowest, mut rest, mut margin, mut power) = (*first, rest, margin, 1.0);
    while lowest.abs() * power
        <= ON_THE_EDGE * total + rest.first().map_or(0.0, |next| next.abs() * power * resolution)
    {
        margin = rest;
        (lowest, rest) = match rest.split_first() {
            Some((first, rest)) => (*first, rest),
            None => return None,
        };
        power *= until;
    }
    if lowest < 0.0 {
        return Some(0.0);
    }
    let mut from = 0.0;
    let mut falling = true;
    for look in 1..=LOOKS {
        let to = until * f64::from(look) / f64::from(LOOKS);
        let still_falling = slope(margin, to) < 0.0;
        if value(margin, to) < 0.0 {
            return Some(crate::root::bracketed(from, to, |time| value(margin, time)));
        }
        if falling && !still_falling {
            // A short visit behind the edge, between two looks.
            let lowest = crate::root::bracketed(from, to, |time| -slope(margin, time));
            if value(margin, lowest) < 0.0 {
                return Some(crate::root::bracketed(from, lowest, |time| value(margin, time)));
            }
        }
        falling = still_falling;
        from = to;
    }
    None
}
