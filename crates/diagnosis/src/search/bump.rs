//! Test functions of the weak form, as weights of samples.

use dynamics::weak_form::test_function;

/// Length of a bump in periods, and the number of bumps that begin within one length.
const PERIODS: f64 = 0.5;
const OVERLAP: f64 = 4.0;

/// Exponent n of a bump (1 − s²)ⁿ.
const EXPONENT: i32 = 4;

/// Samples in a bump: its length where the readings are sparse, and the fewest where some are missing.
const ENOUGH: f64 = 12.0;
const FEWEST: usize = 8;

/// Weights of the samples in the integrals of a function times φ, φ̇ and φ̈, with φ = (1 − s²)ⁿ for |s| < 1.
pub(crate) struct Bump {
    first: usize,
    weights: Vec<[f64; 3]>,
}

impl Bump {
    /// Creates a bump with a half width about a center, by the trapezoidal rule; `None` if it covers too few
    /// samples.
    fn about(center: f64, half: f64, times: &[f64]) -> Option<Self> {
        let first = times.partition_point(|time| *time <= center - half);
        let end = times.partition_point(|time| *time < center + half);
        if end < first + FEWEST {
            return None;
        }
        let weight = |at: usize| {
            let time = *times.get(at)?;
            // φ is 0 at the ends of a segment.
            let before = at.checked_sub(1).and_then(|before| times.get(before)).unwrap_or(&time);
            let width = 0.5 * (times.get(at + 1).unwrap_or(&time) - before);
            let [phi, slope, bend] = test_function((time - center) / half, EXPONENT);
            Some([phi, slope / half, bend / (half * half)].map(|phi| phi * width))
        };
        Some(Self { first, weights: (first..end).filter_map(weight).collect() })
    }

    /// Returns the integrals of a series times φ, φ̇ and φ̈.
    pub(crate) fn integrals(&self, values: &[f64]) -> [f64; 3] {
        let mut sums = [0.0; 3];
        for (weights, value) in self.weights.iter().zip(values.iter().skip(self.first)) {
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum += weight * value;
            }
        }
        sums
    }
}

/// Returns bumps over a segment, [`OVERLAP`] of which begin within the length of one.
pub(crate) fn bumps(times: &[f64], period: f64) -> Vec<Bump> {
    let (Some(&first), Some(&last)) = (times.first(), times.last()) else { return Vec::new() };
    let interval = (last - first) / (times.len().max(2) - 1) as f64;
    let length = (PERIODS * period).max(ENOUGH * interval);
    let count = ((last - first - length) / length * OVERLAP).floor();
    if count < 0.0 {
        return Vec::new();
    }
    let center = |number: usize| first + length * (0.5 + number as f64 / OVERLAP);
    (0..=count as usize).filter_map(|number| Bump::about(center(number), 0.5 * length, times)).collect()
}

#[cfg(test)]
mod tests {
    use super::Bump;

    /// ∫(1 − s²)⁴ ds = 256/315. Integrated by parts, φ̈ gives the second derivative of a parabola, φ̇ minus
    /// the slope of a line.
    #[test]
    fn bumps_differentiate_what_they_are_integrated_with() {
        let times: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.01).collect();
        let bump = Bump::about(1.0, 0.8, &times).unwrap();
        let area = 0.8 * 256.0 / 315.0;
        let of = |f: fn(f64) -> f64| times.iter().map(|t| f(*t)).collect::<Vec<f64>>();
        let near = |found: f64, wanted: f64| assert!((found / wanted - 1.0).abs() < 1e-6, "{found} {wanted}");
        let [whole, ..] = bump.integrals(&of(|_| 1.0));
        near(whole, area);
        let [_, slope, _] = bump.integrals(&of(|t| 3.0 * t));
        near(slope, -3.0 * area);
        let [.., bend] = bump.integrals(&of(|t| 3.0 * t * t));
        near(bend, 6.0 * area);
    }
}
