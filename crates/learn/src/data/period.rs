//! Typical period and sensor noise of records.

use super::Trajectory;

/// Estimates the typical period of the motion in seconds: the mean distance between crossings of the mean.
///
/// A dead band of a fifth of the standard deviation keeps noise from adding crossings. `None` for fewer than
/// three crossings.
#[must_use]
pub fn period(parts: &[Trajectory]) -> Option<f64> {
    let (mut spans, mut crossings) = (0.0, 0);
    for part in parts {
        let count = part.len().max(1) as f64;
        let mean = part.values().iter().sum::<f64>() / count;
        let square = part.values().iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
        let band = 0.2 * square.sqrt();
        let mut side = 0.0;
        let mut found: Vec<f64> = Vec::new();
        for (&time, &value) in part.times_s().iter().zip(part.values()) {
            let away = value - mean;
            if away.abs() > band && away.signum() != side {
                if side != 0.0 {
                    found.push(time);
                }
                side = away.signum();
            }
        }
        if let Some((first, last)) = found.first().zip(found.last()) {
            spans += last - first;
            crossings += found.len() - 1;
        }
    }
    (crossings >= 2).then(|| 2.0 * spans / crossings as f64)
}

/// Estimates the standard deviation of white sensor noise from sixth differences: a smooth motion leaves
/// almost nothing in them, white noise leaves √924 times its standard deviation.
#[must_use]
pub fn noise_floor(parts: &[Trajectory]) -> f64 {
    let (mut sum, mut count) = (0.0, 0_usize);
    for part in parts {
        for window in part.values().windows(7) {
            let weights = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
            let difference: f64 = window.iter().zip(weights).map(|(value, weight)| value * weight).sum();
            sum += difference * difference;
            count += 1;
        }
    }
    (sum / (924.0 * count.max(1) as f64)).sqrt().max(f64::MIN_POSITIVE)
}
