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
/// of a period.
#[must_use]
pub fn first_guess(piece: &Trajectory, period_s: f64) -> State {
    let interval = piece.duration_s() / piece.len().saturating_sub(1).max(1) as f64;
    // A piece has more than three samples.
    let first = piece.times_s().first().copied().unwrap_or_default();
    let half = (0.25 * period_s).max(6.5 * interval);
    let found = local_state(piece, 0, first, half);
    // As above.
    let crude = State { position: piece.values().first().copied().unwrap_or_default(), velocity: 0.0 };
    found.map_or(crude, |state| State { position: state.position, velocity: state.velocity })
}
