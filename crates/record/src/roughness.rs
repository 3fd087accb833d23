//! Comparison of two clocks by the smoothness of the values on each.

#![allow(clippy::indexing_slicing, reason = "the closure runs only for a value")]

/// Number of samples whose sum is one draw: neighborhoods that share samples are correlated, blocks are
/// hardly so.
const BLOCK: usize = 25;

/// Returns the standard errors by which the values contradict the stamps more than the even clock; negative
/// if they contradict the even clock more. Without motion, or without scatter of the stamps, it is at most a
/// standard normal draw.
///
/// Five neighbors deviate from a cubic by one number, their fourth divided difference scaled to unit noise: h
/// on the stamps and e on the even clock. If the sensor was read at the stamps, h is noise, and is
/// independent of q = h − e, the mark of the stamps' scatter (scatter times speed). If it was read at the
/// times of the even clock, e is noise. Noise alone adds σ²·(1 − cos α) to h·q and to −e·q, where α is the
/// angle between the two sets of weights and σ² the smaller of the mean squares of h and e. So the sum H = Σ
/// (h·q − σ²·(1 − cos α)) contradicts the stamps, and the sum E = Σ (−e·q − σ²·(1 − cos α)) contradicts the
/// even clock. The ratio E/(H + E) is the share of the scatter that the values follow. This is a regression
/// of the deviations on the mark of the scatter; a comparison of squares would need twice the scatter. The
/// standard error comes from sums over blocks of the residual beside that share. The contradiction is
/// weighted down as the share approaches one half. Stamps must increase.
pub(crate) fn preference_for_even(stamps: &[f64], values: &[f64], even: &[f64]) -> f64 {
    let windows = stamps.windows(5).zip(even.windows(5)).zip(values.windows(5));
    let marks: Vec<Mark> = windows.map(|((stamps, even), values)| Mark::of(stamps, even, values)).collect();
    let square = |part: fn(&Mark) -> f64| {
        marks.iter().map(|mark| part(mark) * part(mark)).sum::<f64>() / marks.len().max(1) as f64
    };
    let noise = square(|mark| mark.host).min(square(|mark| mark.even));
    let of_host = |mark: &Mark| mark.host * (mark.host - mark.even) - noise * (1.0 - mark.cosine);
    let of_even = |mark: &Mark| mark.even * (mark.even - mark.host) - noise * (1.0 - mark.cosine);
    let against_host: f64 = marks.iter().map(of_host).sum();
    let against_even: f64 = marks.iter().map(of_even).sum();
    let all = against_host + against_even;
    // Share of the scatter that the values follow: 0 for the even clock, 1 for the stamps.
    let shared = against_even / all;
    let beside = |mark: &Mark| (1.0 - shared) * of_even(mark) - shared * of_host(mark);
    let squares = marks.chunks(BLOCK).map(|block| block.iter().map(beside).sum::<f64>().powi(2));
    let error = squares.sum::<f64>().sqrt();
    let preference = if shared < 0.5 {
        against_host / error * (1.0 - 2.0 * shared).min(1.0)
    } else {
        -against_even / error * (2.0 * shared - 1.0).min(1.0)
    };
    // Without scatter, or without motion beyond the noise, there is no evidence for either clock.
    if preference.is_finite() && all > 0.0 { preference } else { 0.0 }
}

/// Deviations of five neighbors from a cubic on either clock.
struct Mark {
    host: f64,
    even: f64,
    /// Cosine of the angle between the two sets of weights.
    cosine: f64,
}

impl Mark {
    fn of(stamps: &[f64], even: &[f64], values: &[f64]) -> Self {
        let (of_host, of_even) = (weights(stamps), weights(even));
        let product: f64 = of_host.iter().zip(&of_even).map(|(host, even)| host * even).sum();
        Self {
            host: weighed(&of_host, values),
            even: weighed(&of_even, values),
            cosine: product / (length(&of_host) * length(&of_even)),
        }
    }
}

/// Returns the weights of five points in their fourth divided difference: 1/Π (tᵢ − tⱼ).
fn weights(times: &[f64]) -> [f64; 5] {
    let mut weights = [0.0; 5];
    for (at, (slot, time)) in weights.iter_mut().zip(times).enumerate() {
        let others = times.iter().enumerate().filter(|(other, _)| *other != at);
        *slot = 1.0 / others.map(|(_, other)| time - other).product::<f64>();
    }
    weights
}

fn length(weights: &[f64; 5]) -> f64 {
    weights.iter().map(|weight| weight * weight).sum::<f64>().sqrt()
}

/// Returns Σ cᵢ·yᵢ with the weights scaled to Σ cᵢ² = 1.
fn weighed(weights: &[f64; 5], values: &[f64]) -> f64 {
    debug_assert_eq!(values.len(), weights.len(), "a weight for each of five values");
    // Relative to the first value, so that values at rest lie exactly on the cubic.
    let sum: f64 = weights.iter().zip(values).map(|(weight, value)| weight * (value - values[0])).sum();
    sum / length(weights)
}

/// Returns the distance of five points from a cubic, in units of a point's noise: their scaled fourth divided
/// difference.
pub(crate) fn off_cubic(times: &[f64], values: &[f64]) -> f64 {
    weighed(&weights(times), values)
}

#[cfg(test)]
mod tests {
    use super::preference_for_even;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    const SAMPLES: usize = 6500;

    /// Returns the preferences of 200 records of a decaying swing of amplitude 1 with noise 1e-3, whose
    /// stamps scatter by `scatter` seconds. If `host` is true, the values were read at the times of the
    /// stamps.
    fn preferences(amplitude: f64, scatter: f64, host: bool) -> Vec<f64> {
        let mut generator = ChaCha8Rng::seed_from_u64(5);
        let mut normal = move || generator.sample::<f64, _>(StandardNormal);
        let even: Vec<f64> = (0..SAMPLES).map(|index| index as f64 / 260.0).collect();
        let record = |_: usize| {
            let stamps: Vec<f64> = even.iter().map(|time| time + scatter * normal()).collect();
            let read = if host { &stamps } else { &even };
            let motion = |time: f64| amplitude * (-0.1 * time).exp() * (33.0 * time).cos();
            let values: Vec<f64> = read.iter().map(|time| motion(*time) + 1e-3 * normal()).collect();
            preference_for_even(&stamps, &values, &even)
        };
        (0..200).map(record).collect()
    }

    fn above(preferences: &[f64], limit: f64) -> usize {
        preferences.iter().filter(|preference| **preference > limit).count()
    }

    /// The scatter times the root mean square speed is 0.15 times the noise of one sample; over all samples
    /// together it is twelve times the noise.
    #[test]
    fn scatter_of_twelve_times_the_noise_is_seen_whichever_clock_is_right() {
        let scatter = 0.15e-3 / (33.0 * 0.5_f64.sqrt() * ((1.0 - (-5.0_f64).exp()) / 5.0).sqrt());
        let (host, even) = (preferences(1.0, scatter, true), preferences(1.0, scatter, false));
        assert!(above(&even, 2.33) >= 190, "{}", above(&even, 2.33));
        assert_eq!(above(&host, 0.0), 0);
        assert!(above(&host, -2.33) <= 5, "{}", above(&host, -2.33));
    }

    #[test]
    fn without_motion_nothing_is_preferred_beyond_chance() {
        for scatter in [1e-5, 1e-4, 4e-4] {
            for host in [true, false] {
                let found = preferences(0.0, scatter, host);
                let (even, stamps) = (above(&found, 2.33), 200 - above(&found, -2.33));
                assert!(even <= 8 && stamps <= 8, "{scatter}: {even} {stamps}");
            }
        }
    }
}
