//! Windows of past and future, for sequence models.

use super::Trajectory;

/// Stretch of a part: the past that a model gets, and the future that it predicts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// Index of the trajectory within the part.
    pub trajectory: usize,
    /// First sample of the past.
    pub from: usize,
    /// First sample of the future.
    pub now: usize,
    /// End of the future (exclusive).
    pub to: usize,
}

/// Cuts trajectories into windows of `past` plus `future` samples, one every `stride` samples, in the order
/// of trajectories and times.
#[must_use]
pub fn windows(parts: &[Trajectory], past: usize, future: usize, stride: usize) -> Vec<Window> {
    let of = |(trajectory, part): (usize, &Trajectory)| {
        let starts = (0..(part.len() + 1).saturating_sub(past + future)).step_by(stride.max(1));
        starts.map(move |from| Window { trajectory, from, now: from + past, to: from + past + future })
    };
    parts.iter().enumerate().flat_map(of).collect()
}
