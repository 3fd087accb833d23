//! The period of a swing, from the values alone.

use crate::noise::statistics::{mean, median};

/// A swing as the values show it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Swing {
    /// Twice the median time between crossings of the middle, in seconds.
    pub(crate) period_s: f64,
    /// Number of full cycles seen.
    pub(crate) cycles: f64,
    /// When it first crosses the middle, in seconds.
    pub(crate) first_s: f64,
}

/// Part of the largest deflection below which a crossing may be noise.
const THRESHOLD: f64 = 0.04;

/// Finds a swing about the mean by its crossings; `None` where fewer than two are seen.
///
/// A crossing counts once the values have gone from beyond the threshold on one side to beyond it on the other,
/// so that noise on a slow crossing is no swing. Its time is interpolated.
pub(crate) fn swing(times: &[f64], values: &[f64]) -> Option<Swing> {
    let middle = mean(values);
    let largest = values.iter().map(|v| (v - middle).abs()).fold(0.0, f64::max);
    let threshold = THRESHOLD * largest;
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
    let halves: Vec<f64> =
        crossings.iter().zip(crossings.iter().skip(1)).map(|(one, next)| next - one).collect();
    crossings.first().filter(|_| !halves.is_empty()).map(|&first_s| Swing {
        period_s: 2.0 * median(&halves),
        cycles: 0.5 * (halves.len() + 1) as f64,
        first_s,
    })
}

#[cfg(test)]
mod tests {
    use super::swing;

    #[test]
    fn a_decay_with_an_offset_and_noise() {
        let times: Vec<f64> = (0..2600).map(|i| i as f64 / 260.0).collect();
        let values: Vec<f64> = times
            .iter()
            .enumerate()
            .map(|(i, t)| {
                0.02 + 0.7 * (-0.13 * t).exp() * (22.0 * t).cos()
                    + 1e-3 * ((i * 7919 % 13) as f64 - 6.0) / 6.0
            })
            .collect();
        let found = swing(&times, &values).unwrap();
        assert!((found.period_s / (std::f64::consts::TAU / 22.0) - 1.0).abs() < 2e-3, "{found:?}");
        assert!((found.cycles - 35.0).abs() <= 1.0, "{found:?}");
    }

    #[test]
    fn no_swing_in_a_creep() {
        let times: Vec<f64> = (0..100).map(f64::from).collect();
        let values: Vec<f64> = times.iter().map(|t| (-0.1 * t).exp()).collect();
        assert_eq!(swing(&times, &values), None);
    }
}
