//! Period of a swing, computed from the values alone.

use crate::noise::statistics::{mean, median};

/// Swing found in the values of a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Swing {
    /// Median time from a crossing of the middle to the next but one, in seconds.
    pub(crate) period_s: f64,
    /// Number of full cycles seen.
    pub(crate) cycles: f64,
    /// Time of the first crossing of the middle, in seconds.
    pub(crate) first_s: f64,
}

/// Part of the largest deflection below which a crossing may be noise.
const THRESHOLD: f64 = 0.04;

/// Thresholds that are tried if the crossings come at irregular intervals.
const HIGHER: [f64; 4] = [0.04, 0.1, 0.25, 0.5];

/// Median distance of the periods from their median, relative to it, up to which they count as regular.
const REGULAR: f64 = 0.2;

/// Minimum number of periods needed to judge their regularity.
const FEWEST: usize = 5;

/// Times at which the values cross the middle, in seconds.
struct Crossings(Vec<f64>);

/// Finds a swing about the mean by its crossings; `None` if fewer than two are seen.
///
/// A crossing counts once the values have gone from beyond the threshold on one side to beyond it on the
/// other, so that noise on a slow crossing does not count as a swing. The time of the crossing is
/// interpolated.
///
/// Crossings at irregular intervals come from noise, wrong readings or steps of the sensor. In that case the
/// values are replaced by medians of three neighbors, higher thresholds are tried too, and the most regular
/// crossings are used.
pub(crate) fn swing(times: &[f64], values: &[f64]) -> Option<Swing> {
    let first = Crossings::of(times, values, THRESHOLD);
    if first.irregularity().is_some_and(|own| own <= REGULAR) {
        return first.swing();
    }
    let filtered = medians_of_three(values);
    let others = HIGHER.map(|threshold| Crossings::of(times, &filtered, threshold));
    let all = [&first].into_iter().chain(&others).filter_map(|own| Some((own.irregularity()?, own)));
    let regular = all.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, own)| own);
    regular.unwrap_or(&first).swing()
}

impl Crossings {
    fn of(times: &[f64], values: &[f64], threshold: f64) -> Self {
        let middle = mean(values);
        let largest = values.iter().map(|v| (v - middle).abs()).fold(0.0, f64::max);
        let threshold = threshold * largest;
        let mut side = 0.0;
        let mut crossing = None;
        let mut crossings = Vec::new();
        let pairs = times.iter().zip(values).zip(times.iter().zip(values).skip(1));
        for ((&before, &low), (&after, &high)) in pairs {
            let (low, high) = (low - middle, high - middle);
            if low * high <= 0.0 && low != high {
                crossing = Some(before + (after - before) * low / (low - high));
            }
            if high.abs() > threshold && high.signum() != side {
                if side != 0.0 {
                    crossings.extend(crossing);
                }
                side = high.signum();
            }
        }
        Self(crossings)
    }

    /// Returns the times between crossings that are `apart` crossings apart, in seconds.
    fn intervals(&self, apart: usize) -> Vec<f64> {
        self.0.iter().zip(self.0.iter().skip(apart)).map(|(one, next)| next - one).collect()
    }

    /// Returns the median distance of the periods from their median, relative to it; `None` for fewer than
    /// [`FEWEST`] periods.
    fn irregularity(&self) -> Option<f64> {
        let periods = self.intervals(2);
        if periods.len() < FEWEST {
            return None;
        }
        let middle = median(&periods);
        let distances: Vec<f64> = periods.iter().map(|own| (own - middle).abs()).collect();
        Some(median(&distances) / middle)
    }

    fn swing(&self) -> Option<Swing> {
        let halves = self.intervals(1);
        let periods = self.intervals(2);
        self.0.first().filter(|_| !halves.is_empty()).map(|&first_s| Swing {
            // If the middle is off, every second half period is longer; full periods are not affected.
            period_s: if periods.is_empty() { 2.0 * median(&halves) } else { median(&periods) },
            cycles: 0.5 * (halves.len() + 1) as f64,
            first_s,
        })
    }
}

/// Replaces each value by the median of itself and its two neighbors, which removes single wrong readings.
fn medians_of_three(values: &[f64]) -> Vec<f64> {
    let at = |index: usize| values.get(index).copied();
    let of = |(index, own): (usize, &f64)| {
        let around = [index.checked_sub(1).and_then(at), Some(*own), at(index + 1)];
        median(&around.into_iter().flatten().collect::<Vec<f64>>())
    };
    values.iter().enumerate().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::swing;
    use std::f64::consts::TAU;

    const OMEGA: f64 = 22.0;

    /// Decay of 10 s with an offset and a little noise, 260 samples a second.
    fn decay() -> (Vec<f64>, Vec<f64>) {
        let times: Vec<f64> = (0..2600).map(|i| i as f64 / 260.0).collect();
        let noise = |i: usize| 1e-3 * ((i * 7919 % 13) as f64 - 6.0) / 6.0;
        let swing = |t: f64| 0.02 + 0.7 * (-0.13 * t).exp() * (OMEGA * t).cos();
        let values = times.iter().enumerate().map(|(i, t)| swing(*t) + noise(i)).collect();
        (times, values)
    }

    fn assert_period(times: &[f64], values: &[f64], tolerance: f64, of: &str) {
        let found = swing(times, values).unwrap();
        assert!((found.period_s / (TAU / OMEGA) - 1.0).abs() < tolerance, "{of}: {found:?}");
    }

    #[test]
    fn a_decay_with_an_offset_and_noise() {
        let (times, values) = decay();
        assert_period(&times, &values, 2e-3, "a decay");
        let found = swing(&times, &values).unwrap();
        assert!((found.cycles - 35.0).abs() <= 1.0, "{found:?}");
    }

    /// Every tenth reading is wrong, to alternating sides.
    #[test]
    fn wrong_readings_make_no_swing() {
        let (times, mut values) = decay();
        for (at, value) in values.iter_mut().enumerate().skip(3).step_by(10) {
            *value = if at % 20 == 3 { 1.6 } else { -1.5 };
        }
        assert_period(&times, &values, 0.02, "wrong readings");
    }

    /// Noise of a seventh of the first amplitude; a sensor of seven steps a swing with such noise; and a
    /// sensor that does not show the middle half of the swing.
    #[test]
    fn noise_steps_and_dead_zones() {
        let (times, values) = decay();
        let mut state = 1_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let noisy: Vec<f64> = values.iter().map(|own| own + 0.35 * uniform()).collect();
        assert_period(&times, &noisy, 0.02, "noise");
        let steps: Vec<f64> = noisy.iter().map(|own| (own / 0.2).round() * 0.2).collect();
        assert_period(&times, &steps, 0.02, "steps");
        let dead = values.iter().map(|own| own - own.clamp(-0.15, 0.15)).collect::<Vec<f64>>();
        assert_period(&times, &dead, 0.05, "a dead zone");
    }

    #[test]
    fn no_swing_in_a_creep() {
        let times: Vec<f64> = (0..100).map(f64::from).collect();
        let values: Vec<f64> = times.iter().map(|t| (-0.1 * t).exp()).collect();
        assert_eq!(swing(&times, &values), None);
    }
}
