//! High-pass filter by a moving mean over one period.

#![allow(clippy::indexing_slicing, reason = "times, values and integrals are equally long")]

/// Returns the integrals of a polygon from its first time to each of its times.
fn integrals(times: &[f64], values: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = times.iter().zip(times.iter().skip(1)).zip(values.iter().zip(values.iter().skip(1)));
    let ends = steps.map(|((from, to), (one, next))| {
        sum += 0.5 * (to - from) * (one + next);
        sum
    });
    std::iter::once(0.0).chain(ends).collect()
}

/// Returns the integral of a polygon from its first time to any time within it.
fn integral(times: &[f64], values: &[f64], integrals: &[f64], time: f64) -> f64 {
    debug_assert!(values.len() == times.len() && integrals.len() == times.len());
    let last = times.len().saturating_sub(2);
    let at = times.partition_point(|own| *own <= time).saturating_sub(1).min(last);
    let (Some(&[from, to]), Some(&[one, next])) = (
        times.get(at..at + 2).and_then(|own| own.first_chunk()),
        values.get(at..at + 2).and_then(|own| own.first_chunk()),
    ) else {
        // Fewer than two samples span no time.
        return 0.0;
    };
    let part = time - from;
    let slope = if to > from { (next - one) / (to - from) } else { 0.0 };
    integrals[at] + part * (one + 0.5 * part * slope)
}

/// Subtracts from every value the mean of the polygon through the values over a period centered on it; at the
/// ends of the series, over the first or last period. A swing of this period stays as it is; a slow drift
/// vanishes.
pub(crate) fn high_pass(times: &[f64], values: &mut [f64], period: f64) {
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return };
    let period = period.min(last - first);
    if period <= 0.0 {
        return;
    }
    let sums = integrals(times, values);
    let whole = values.to_vec();
    let until = |time: f64| integral(times, &whole, &sums, time);
    for (value, time) in values.iter_mut().zip(times) {
        let from = (time - 0.5 * period).clamp(*first, last - period);
        *value -= (until(from + period) - until(from)) / period;
    }
}

#[cfg(test)]
mod tests {
    use super::high_pass;
    use std::f64::consts::TAU;

    /// Slightly irregular times, nine in a period of 1 s.
    fn times() -> Vec<f64> {
        (0..400).map(|at| f64::from(at) / 9.0 + 0.01 * f64::from(at).sin()).collect()
    }

    fn left(of: impl Fn(f64) -> f64) -> f64 {
        let times = times();
        let mut values: Vec<f64> = times.iter().map(|t| of(*t)).collect();
        let before: f64 = values.iter().map(|value| value * value).sum();
        high_pass(&times, &mut values, 1.0);
        (values.iter().map(|value| value * value).sum::<f64>() / before).sqrt()
    }

    #[test]
    fn a_swing_stays_and_a_drift_goes() {
        for harmonic in [1.0, 2.0, 3.0] {
            let swing = left(|t| (TAU * harmonic * t + 0.3).sin());
            assert!((swing - 1.0).abs() < 0.03, "{harmonic}: {swing}");
        }
        assert!(left(|_| 3.0) < 1e-12);
        let slow = left(|t| (TAU * t / 20.0).sin());
        assert!(slow < 0.03, "{slow}");
    }

    #[test]
    fn what_is_shorter_than_a_period_loses_its_mean() {
        let mut values = [1.0, 2.0, 3.0];
        high_pass(&[0.0, 0.1, 0.2], &mut values, 5.0);
        assert!(values.iter().zip([-1.0, 0.0, 1.0]).all(|(own, right)| (own - right).abs() < 1e-12));
        let mut one = [4.0];
        high_pass(&[0.0], &mut one, 1.0);
        assert_eq!(one, [4.0]);
    }
}
