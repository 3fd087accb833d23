//! Velocity and acceleration by local polynomials, and interpolation between samples, also at uneven times.

#![allow(clippy::indexing_slicing, reason = "a trajectory has an input for every sample")]

use super::Trajectory;
use nalgebra::{SMatrix, SVector};

/// State estimated from neighboring samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalState {
    /// Index of the sample, from 0.
    pub sample: usize,
    /// Time in seconds.
    pub time_s: f64,
    /// Position.
    pub position: f64,
    /// Velocity.
    pub velocity: f64,
    /// Acceleration.
    pub acceleration: f64,
    /// Input; 0 without an input.
    pub input: f64,
}

/// Number of terms of the local polynomial, of degree 4.
const TERMS: usize = 5;

/// Estimates the state at every sample that has neighbors up to `half_width_s` on both sides, by least
/// squares of degree 4 (Savitzky and Golay, Analytical Chemistry 36 (1964) 1627, without their even spacing).
#[must_use]
pub fn local_states(part: &Trajectory, half_width_s: f64) -> Vec<LocalState> {
    let interval = part.duration_s() / part.len().saturating_sub(1).max(1) as f64;
    let half = half_width_s.max(2.5 * interval);
    let (Some(&first), Some(&last)) = (part.times_s().first(), part.times_s().last()) else {
        return Vec::new();
    };
    let ends = |time: f64| time - first >= 0.6 * half && last - time >= 0.6 * half;
    let times = part.times_s().iter().enumerate().filter(|(_, time)| ends(**time));
    times.filter_map(|(sample, &time)| local_state(part, sample, time, half)).collect()
}

/// Estimates the state at a sample from the neighbors within `half` seconds; `None` if they do not determine
/// it.
pub(crate) fn local_state(part: &Trajectory, sample: usize, time: f64, half: f64) -> Option<LocalState> {
    let from = part.times_s().partition_point(|&other| other < time - half);
    let to = part.times_s().partition_point(|&other| other <= time + half);
    let near = part.times_s().get(from..to)?.iter().zip(part.values().get(from..to)?);
    let (mut normal, mut right) = (SMatrix::<f64, TERMS, TERMS>::zeros(), SVector::<f64, TERMS>::zeros());
    for (&other, &value) in near {
        let s = (other - time) / half;
        let row = SVector::<f64, TERMS>::from([1.0, s, s * s, s.powi(3), s.powi(4)]);
        normal += row * row.transpose();
        right += row * value;
    }
    let solved = normal.cholesky()?.solve(&right);
    let [position, slope, curvature, ..] = solved.data.0.first().copied()?;
    Some(LocalState {
        sample,
        time_s: time,
        position,
        velocity: slope / half,
        acceleration: 2.0 * curvature / (half * half),
        input: part.input().map_or(0.0, |input| input[sample]),
    })
}

/// Interpolates the value at a time with Lagrange's cubic through the four samples around it; exact at a
/// sample.
pub(crate) fn interpolated(times: &[f64], values: &[f64], time: f64) -> f64 {
    let next = times.partition_point(|&other| other < time);
    let from = next.saturating_sub(2).min(times.len().saturating_sub(4));
    let near: Vec<(f64, f64)> =
        times.iter().copied().zip(values.iter().copied()).skip(from).take(4).collect();
    let of = |(place, (own, value)): (usize, &(f64, f64))| {
        let others = near.iter().enumerate().filter(|(other, _)| *other != place);
        value * others.map(|(_, (other, _))| (time - other) / (own - other)).product::<f64>()
    };
    near.iter().enumerate().map(of).sum()
}
