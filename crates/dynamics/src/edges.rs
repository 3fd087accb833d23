//! Edges of a smooth piece, at which the law of an effect changes.

use crate::field::{Field, Mode, State};
use crate::scalar::Scalar;

/// Edge of the present smooth piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Edge {
    /// The velocity changes its sign.
    Reversal,
    /// The torque exceeds the holding torque of dry friction, toward positive or negative positions.
    BreakAway {
        /// `true` toward positive positions.
        forward: bool,
    },
    /// An effect leaves its region.
    Region {
        /// Index of the effect in the system.
        term: usize,
        /// Edge of the region, 0 or 1.
        edge: usize,
    },
}

impl<S: Scalar> Field<S> {
    /// Calls `visit` with every edge of the present piece and the signed distance to it: positive inside.
    #[inline]
    pub(crate) fn edges(
        &self,
        directed: bool,
        state: &State<S>,
        mode: &Mode,
        mut visit: impl FnMut(Edge, S),
    ) {
        if mode.sticks() {
            let torque = self.torque(state, mode);
            if let Some(holding) = self.holding_torque(state, mode) {
                visit(Edge::BreakAway { forward: true }, holding - torque);
                visit(Edge::BreakAway { forward: false }, holding + torque);
            }
        } else if directed {
            visit(Edge::Reversal, state.velocity * mode.direction);
        }
        for (term, (own, moment)) in self.moments(state, mode).enumerate() {
            for (edge, margin) in own.effect.margins(&own.values, &moment).into_iter().enumerate() {
                if let Some(margin) = margin {
                    visit(Edge::Region { term, edge }, margin);
                }
            }
        }
    }

    /// Returns the signed distance to one edge; `None` if the present piece does not have it.
    pub(crate) fn distance(&self, directed: bool, state: &State<S>, mode: &Mode, edge: Edge) -> Option<S> {
        let mut found = None;
        self.edges(directed, state, mode, |other, margin| {
            if other == edge {
                found = Some(margin);
            }
        });
        found
    }
}

impl Field<f64> {
    /// Returns the mode behind an edge. At a reversal the velocity has to be exactly zero.
    pub(crate) fn behind(&self, state: &State<f64>, mode: &Mode, edge: Edge) -> Mode {
        match edge {
            Edge::Reversal => self.mode(state),
            Edge::BreakAway { forward } => self.moving(state, if forward { 1.0 } else { -1.0 }),
            Edge::Region { term, edge } => {
                let mut next = *mode;
                if let (Some(region), Some(term)) = (next.regions.get_mut(term), self.terms.get(term)) {
                    *region = term.effect.beyond(*region, edge);
                }
                next
            }
        }
    }
}
