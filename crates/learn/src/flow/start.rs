//! Initial states of stretches.

use crate::data::{Trajectory, local_state};
use serde::{Deserialize, Serialize};

/// Position and velocity.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct State {
    /// Position in rad or m.
    pub position: f64,
    /// Velocity in rad/s or m/s.
    pub velocity: f64,
}

/// Estimates the state at the first sample of a piece, by a polynomial through the samples within a quarter
/// of a period; at rest at zero for a piece without samples.
#[must_use]
pub fn first_guess(piece: &Trajectory, period_s: f64) -> State {
    let interval = piece.duration_s() / piece.len().saturating_sub(1).max(1) as f64;
    let (Some(&first), Some(&position)) = (piece.times_s().first(), piece.values().first()) else {
        return State::default();
    };
    let half = (0.25 * period_s).max(6.5 * interval);
    let found = local_state(piece, 0, first, half);
    found.map_or(State { position, velocity: 0.0 }, |state| State {
        position: state.position,
        velocity: state.velocity,
    })
}
