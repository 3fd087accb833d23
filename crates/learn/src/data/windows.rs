//! Windows of past and future, for models that learn from sequences.

use super::Trajectory;

/// A stretch of a training part: the past that a model is given, and the future that it has to predict.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// Which trajectory of the part.
    pub trajectory: usize,
    /// First sample of the past.
    pub from: usize,
    /// First sample of the future.
    pub now: usize,
    /// Sample after the last of the future.
    pub to: usize,
}

/// Windows of `past` and `future` samples, every `stride` samples, in the order of trajectories and times.
#[must_use]
pub fn windows(parts: &[Trajectory], past: usize, future: usize, stride: usize) -> Vec<Window> {
    let of = |(trajectory, part): (usize, &Trajectory)| {
        let starts = (0..(part.len() + 1).saturating_sub(past + future)).step_by(stride.max(1));
        starts.map(move |from| Window { trajectory, from, now: from + past, to: from + past + future })
    };
    parts.iter().enumerate().flat_map(of).collect()
}
