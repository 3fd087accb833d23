//! Samples compared with the motion around them, and the white noise that follows.

#![allow(clippy::indexing_slicing, reason = "neighbors are places among the points")]

use crate::data::observations::Observations;
use crate::noise::statistics::median;

/// Ratio of a Gaussian's standard deviation to the median of its absolute value.
pub(crate) const OF_MEDIAN: f64 = 1.4826;

/// Largest spacing of a neighborhood, as the product of its distances over that of an even one. One sample
/// lost in the middle makes it 3; the cubic's own error grows in proportion.
const WIDE: f64 = 4.0;

/// Returns the standard deviation of the white noise of samples, from their distances to their neighbors. It
/// includes rounding, even if the steps are so coarse that most neighbors agree.
pub(crate) fn white_noise(observations: &Observations, kept: &[bool]) -> f64 {
    let points = points(observations, kept);
    let sizes: Vec<f64> =
        distances(&points, 1, interval(observations)).iter().flatten().map(Distance::in_noise).collect();
    (OF_MEDIAN * median(&sizes)).max(observations.step() / 12.0_f64.sqrt())
}

/// Index, time and value of a sample.
pub(crate) type Point = (usize, f64, f64);

pub(crate) fn points(observations: &Observations, kept: &[bool]) -> Vec<Point> {
    let samples = observations.times_s.iter().zip(&observations.values).enumerate();
    let samples = samples.zip(kept).filter(|(_, kept)| **kept);
    samples.map(|((index, (&time, &value)), _)| (index, time, value)).collect()
}

pub(crate) fn interval(observations: &Observations) -> f64 {
    let times = &observations.times_s;
    let steps: Vec<f64> = times.iter().zip(times.iter().skip(1)).map(|(one, next)| next - one).collect();
    median(&steps)
}

/// Distance of a sample from the cubic through its neighbors.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Distance {
    pub(crate) value: f64,
    /// Standard deviation of the distance for white noise of 1.
    pub(crate) spread: f64,
    /// Largest distance that rounding by half a step can cause, for a step of 1.
    pub(crate) rounding: f64,
    sample: Point,
    neighbors: [Point; 4],
}

impl Distance {
    fn new(sample: Point, neighbors: [Point; 4]) -> Self {
        let [value, spread, rounding] = from_polynomial(sample, &neighbors);
        Self { value, spread, rounding, sample, neighbors }
    }

    pub(crate) fn in_noise(&self) -> f64 {
        self.value.abs() / self.spread
    }

    /// Returns the smallest distance from the parabolas through three of the neighbors: small beside a wrong sample and at
    /// a step, where the sample agrees with the others once a neighbor is left out.
    pub(crate) fn parabola_distance(&self) -> f64 {
        let without = |left_out: &Point| {
            let nodes: Vec<Point> = self.neighbors.into_iter().filter(|node| node.0 != left_out.0).collect();
            let [value, ..] = from_polynomial(self.sample, &nodes);
            value.abs()
        };
        self.neighbors.iter().map(without).fold(f64::INFINITY, f64::min)
    }
}

/// Returns the distance of a sample from the polynomial through some nodes, its standard deviation for white noise of 1,
/// and the largest distance by rounding for a step of 1.
fn from_polynomial((_, time, value): Point, nodes: &[Point]) -> [f64; 3] {
    let (mut sum, mut squares, mut sizes) = (0.0, 1.0, 1.0);
    for (own, node) in nodes.iter().enumerate() {
        let others = nodes.iter().enumerate().filter(|(other, _)| *other != own);
        let weight: f64 = others.map(|(_, other)| (time - other.1) / (node.1 - other.1)).product();
        // With differences of values, samples at rest lie on the curve exactly.
        sum += weight * (node.2 - value);
        squares += weight * weight;
        sizes += weight.abs();
    }
    [-sum, squares.sqrt(), 0.5 * sizes]
}

/// Returns the distances of all samples from cubics through the four neighbors once and twice `spacing` away, or through
/// more on one side near an end; `None` where samples in between are missing.
pub(crate) fn distances(points: &[Point], spacing: usize, interval: f64) -> Vec<Option<Distance>> {
    (0..points.len())
        .map(|index| {
            let places = neighbors(index, spacing, points.len())?;
            let nodes = places.map(|place| points[place]);
            let (_, time, _) = points[index];
            let product: f64 = nodes.iter().map(|node| (time - node.1).abs()).product();
            let even: f64 = places.iter().map(|place| place.abs_diff(index) as f64 * interval).product();
            if product.is_nan() || product > WIDE * even {
                return None;
            }
            let distance = Distance::new(points[index], nodes);
            distance.spread.is_finite().then_some(distance)
        })
        .collect()
}

/// Returns the places of a sample's four neighbors at a spacing, two on either side if there are; `None` if there are no four.
fn neighbors(index: usize, spacing: usize, count: usize) -> Option<[usize; 4]> {
    let before = (index / spacing).min(4);
    let after = (count.checked_sub(index + 1)? / spacing).min(4);
    let from_before = before.min(2.max(4_usize.saturating_sub(after)));
    let place = |at: usize| match at < from_before {
        true => index - (from_before - at) * spacing,
        false => index + (at - from_before + 1) * spacing,
    };
    (before + after >= 4).then(|| [0, 1, 2, 3].map(place))
}
