//! Detection of the edge that a step by Taylor series meets first.

use super::march::March;
use super::series::{LENGTH, Series, head, slope, value};
use crate::edges::Edge;
use std::ops::RangeInclusive;

/// Number of parts of a step at which the sign of a margin is evaluated.
const LOOKS: u32 = 8;

/// Size of a margin's coefficient, relative to all, up to which it is rounding: the step begins on the edge.
const ON_THE_EDGE: f64 = 1e-12;

impl March<'_> {
    /// Returns the edge that the step meets first, and the time of the meeting after the step's start.
    pub(super) fn first_edge(&self, number: usize, degree: usize, size: f64) -> Option<(Edge, f64)> {
        let piece = self.model.graphs.get(number)?;
        let mut first: Option<(Edge, f64)> = None;
        let point = self.point();
        let field = &self.model.field;
        // At rest the excess of the torque over the hold may be rounding; its further course is not.
        let rests = point.velocity == 0.0 && field.holding_torque(&point, &self.mode).is_some();
        let balance = if rests { field.balance(&point) } else { 0.0 };
        let resolution = 4.0 * f64::EPSILON * self.time.abs();
        for &(edge, node) in &piece.graph.edges {
            let margin = head(piece.graph.series(node), degree + 1);
            let until = first.map_or(size, |(_, time)| time);
            let time = match edge {
                Edge::BreakAway { .. } if rests => {
                    let known = 2.0 * (balance + resolution * slope(margin, 0.0).abs());
                    from_rest(margin, 0, -known..=known, until, resolution)
                }
                Edge::Reversal if rests => {
                    let next = margin.get(2).map_or(0.0, |next| 2.0 * next.abs());
                    let balance = balance / field.nominal.inertia;
                    from_rest(
                        margin,
                        1,
                        -4.0 * (balance + resolution * next)..=0.5 * balance,
                        until,
                        resolution,
                    )
                }
                _ => crossing(margin, until, Some(resolution)),
            };
            if let Some(time) = time {
                first = Some((edge, time));
            }
        }
        first
    }
}

/// Does the same as [`crossing`] at rest, where the coefficient of one order tells by how much the torque
/// exceeds the holding torque of dry friction. Within `balance` this excess counts as zero.
///
/// A body that sticks, breaks away and turns back at once must not do so without end. So the three tests
/// differ by more than rounding in their limits of balance. A body may stick up to
/// [`Field::balance`](crate::field::Field::balance) beyond the hold. It breaks away because of the torque's
/// slope within twice that. It turns back because of the slope from four times that short of the hold to half
/// of it beyond.
fn from_rest(
    margin: &[f64],
    order: usize,
    balance: RangeInclusive<f64>,
    until: f64,
    resolution: f64,
) -> Option<f64> {
    if margin.get(order).is_some_and(|excess| !balance.contains(excess)) {
        return crossing(margin, until, None);
    }
    let mut balanced: Series = [0.0; LENGTH];
    for (slot, coefficient) in balanced.iter_mut().zip(margin).skip(order + 1) {
        *slot = *coefficient;
    }
    crossing(head(&balanced, margin.len()), until, Some(resolution))
}

/// Returns the time at which a margin, positive now, first becomes negative within a time; 0 if it is about
/// to. `resolution` is the accuracy of the present time. Without it, the first coefficient that is not zero
/// is known not to be rounding.
fn crossing(margin: &[f64], until: f64, resolution: Option<f64>) -> Option<f64> {
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
    // On the edge itself the lowest coefficients are rounding; the further course of the margin decides.
    let (mut lowest, mut rest, mut margin, mut power) = (*first, rest, margin, 1.0);
    let rounding = |rest: &[f64], power: f64| {
        let Some(resolution) = resolution else { return 0.0 };
        let next = rest.first().map_or(0.0, |next| next.abs() * power);
        ON_THE_EDGE * total + next * resolution
    };
    while lowest.abs() * power <= rounding(rest, power) {
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
            // The margin may be negative for a short time between two evaluations.
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
