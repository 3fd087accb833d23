//! Lines in values over time, at even or uneven times.

#![allow(clippy::indexing_slicing, reason = "lanes are of a fixed number")]

use crate::noise::statistics::mean;

/// Returns the highest angular frequency at which samples `interval` seconds apart tell frequencies from
/// their aliases: 0.8 of the Nyquist frequency, which leaves room for a line's width.
pub(crate) fn below_images(interval: f64) -> f64 {
    0.8 * std::f64::consts::PI / interval
}

/// Line and its gain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    /// Angular frequency in rad/s.
    pub(crate) frequency: f64,
    /// Decrease of the sum of squares by a sine and a cosine of this frequency.
    pub(crate) gain: f64,
}

/// Largest number of frequencies on a grid.
pub(crate) const MOST_FREQUENCIES: usize = 4000;

/// Samples that are rotated and summed side by side, whatever the processor; and the number of such groups that go through all
/// frequencies together, few enough to stay near the processor.
const LANES: usize = 4;
const GROUPS: usize = 128;

/// Some samples: their phasors at a frequency, the rotations to the next one, and their values. Beyond the last sample the
/// values are zero.
#[derive(Debug, Clone, Copy, Default)]
struct Lanes {
    sines: [f64; LANES],
    cosines: [f64; LANES],
    sine_steps: [f64; LANES],
    cosine_steps: [f64; LANES],
    values: [f64; LANES],
}

impl Lanes {
    fn new(points: &[(f64, f64)], lowest: f64, step: f64) -> Self {
        let mut lanes = Self::default();
        for (lane, (time, value)) in points.iter().enumerate() {
            (lanes.sines[lane], lanes.cosines[lane]) = libm::sincos(lowest * time);
            (lanes.sine_steps[lane], lanes.cosine_steps[lane]) = libm::sincos(step * time);
            lanes.values[lane] = *value;
        }
        lanes
    }

    /// Adds the samples to the sums of the sines and of the cosines, and turns the phasors to the next frequency.
    fn add(&mut self, sums: &mut [[f64; LANES]; 2]) {
        (0..LANES).for_each(|lane| {
            let (sine, cosine, value) = (self.sines[lane], self.cosines[lane], self.values[lane]);
            let (ahead, along) = (self.sine_steps[lane], self.cosine_steps[lane]);
            sums[0][lane] += value * sine;
            sums[1][lane] += value * cosine;
            self.sines[lane] = sine * along + cosine * ahead;
            self.cosines[lane] = cosine * along - sine * ahead;
        });
    }
}

/// Adds to each gain on a grid of frequencies the decrease of the sum of squares by a sine and a cosine.
/// `points` are times, even or uneven, and values already multiplied with weights; `squares` is the sum of
/// the squared weights.
///
/// The phasor of each sample is rotated from one frequency to the next, which costs four products instead of
/// a sine and a cosine.
pub(crate) fn add(points: &[(f64, f64)], squares: f64, lowest: f64, step: f64, gains: &mut [f64]) {
    let mut sums = vec![[[0.0; LANES]; 2]; gains.len()];
    for part in points.chunks(LANES * GROUPS) {
        let mut lanes: Vec<Lanes> = part.chunks(LANES).map(|own| Lanes::new(own, lowest, step)).collect();
        for sums in &mut sums {
            for own in &mut lanes {
                own.add(sums);
            }
        }
    }
    let scale = 2.0 / squares.max(f64::MIN_POSITIVE);
    for (gain, sums) in gains.iter_mut().zip(sums) {
        let [sine, cosine] = sums.map(|own| own.iter().sum::<f64>());
        *gain += scale * (sine * sine + cosine * cosine);
    }
}

/// Returns the highest peaks of gains on a grid.
pub(crate) fn peaks(gains: &[f64], lowest: f64, step: f64, most: usize) -> Vec<Line> {
    // Beyond the grid there is no gain.
    let bordered = [&[0.0], gains, &[0.0]].concat();
    let mut peaks: Vec<Line> = bordered
        .array_windows()
        .enumerate()
        .filter(|(_, [before, gain, after])| gain > before && gain >= after)
        .map(|(i, &[_, gain, _])| Line { frequency: lowest + step * i as f64, gain })
        .collect();
    peaks.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    peaks.truncate(most);
    peaks
}

/// Longest span, in shortest periods of a swing, over which its strongest line is searched for.
const PERIODS: f64 = 200.0;

/// Returns the period in seconds of the strongest line in values about their mean. It may be shorter than
/// `shortest` by up to a factor of five. `None` if the values are too short for a line.
pub(crate) fn strongest_period(times: &[f64], values: &[f64], shortest: f64) -> Option<f64> {
    let (first, last) = (times.first()?, times.last()?);
    let span = (last - first).min(PERIODS * shortest);
    let seen = times.iter().zip(values).take_while(|(time, _)| **time - first <= span);
    let (times, values): (Vec<f64>, Vec<f64>) = seen.map(|(time, value)| (time - first, *value)).unzip();
    let middle = mean(&values);
    let points: Vec<(f64, f64)> = times.into_iter().zip(values.iter().map(|own| own - middle)).collect();
    let highest = below_images(span / points.len().max(1) as f64).min(5.0 * std::f64::consts::TAU / shortest);
    let lowest = 1.5 * std::f64::consts::TAU / span;
    let count = ((highest - lowest) * span / std::f64::consts::PI).min(MOST_FREQUENCIES as f64);
    if count.is_nan() || count < 2.0 {
        return None;
    }
    let step = (highest - lowest) / count;
    let mut gains = vec![0.0; count as usize];
    add(&points, points.len() as f64, lowest, step, &mut gains);
    peaks(&gains, lowest, step, 1).first().map(|line| std::f64::consts::TAU / line.frequency)
}

/// Largest number of frequencies among which a dominant line is searched for. [`FINER`] is the number of
/// steps of the fine grid about it.
const MOST_DOMINANT: usize = 1000;
const FINER: f64 = 40.0;

/// Smallest share of the squares that a dominant line holds.
const DOMINANT: f64 = 0.5;

/// Returns the share of the squares of values about their mean that a sine and a cosine of an angular
/// frequency explain.
pub(crate) fn share(times: &[f64], values: &[f64], frequency: f64) -> f64 {
    let middle = mean(values);
    let points: Vec<(f64, f64)> =
        times.iter().zip(values).map(|(time, value)| (*time, value - middle)).collect();
    let squares: f64 = points.iter().map(|(_, value)| value * value).sum();
    let mut gain = [0.0];
    add(&points, points.len() as f64, frequency, 0.0, &mut gain);
    gain.iter().sum::<f64>() / squares.max(f64::MIN_POSITIVE)
}

/// Power of a line relative to its neighbors, and its share of the squares, from which on it stands out. White
/// noise exceeds its mean by this factor in one of 5e8 bins.
const STANDS_OUT: f64 = 20.0;
const LEAST_SHARE: f64 = 0.003;

/// Returns `true` if values have a line at an angular frequency: their power there stands out from that three to
/// six resolutions beside it.
pub(crate) fn has_line(times: &[f64], values: &[f64], frequency: f64) -> bool {
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return false };
    let resolution = std::f64::consts::TAU / (last - first).max(f64::MIN_POSITIVE);
    let share = |off: f64| share(times, values, (frequency + off * resolution).max(resolution));
    let own = [-0.5, -0.25, 0.0, 0.25, 0.5].map(share).into_iter().fold(0.0, f64::max);
    let beside = [3.0, 4.0, 5.0, 6.0].map(|off| 0.5 * (share(off) + share(-off)));
    own > LEAST_SHARE && own > STANDS_OUT * mean(&beside)
}

/// Returns the angular frequency of the line that holds most of the squares of values about their mean;
/// `None` if there is no such line.
pub(crate) fn dominant_frequency(times: &[f64], values: &[f64]) -> Option<f64> {
    let (first, last) = (times.first()?, times.last()?);
    let resolution = std::f64::consts::TAU / (last - first);
    let middle = mean(values);
    let points: Vec<(f64, f64)> =
        times.iter().zip(values).map(|(time, value)| (time - first, value - middle)).collect();
    let squares: f64 = points.iter().map(|(_, value)| value * value).sum();
    let count = (times.len() / 2).min(MOST_DOMINANT);
    let strongest = |lowest: f64, step: f64, count: usize| {
        let mut gains = vec![0.0; count];
        add(&points, points.len() as f64, lowest, step, &mut gains);
        peaks(&gains, lowest, step, 1).first().copied()
    };
    // On a grid with a step of half the resolution, a line between two frequencies keeps 0.8 of its squares.
    let coarse = strongest(1.5 * resolution, 0.5 * resolution, count)?;
    let step = 2.0 * resolution / FINER;
    let fine = strongest(coarse.frequency - resolution, step, FINER as usize + 1)?;
    (fine.gain > DOMINANT * squares).then_some(fine.frequency)
}

#[cfg(test)]
mod tests {
    use super::{add, dominant_frequency, peaks, share, strongest_period};

    /// A swing of 0.4 s under noise of its own size.
    #[test]
    fn a_swing_in_noise_has_its_period() {
        let times: Vec<f64> = (0..3000).map(|at| f64::from(at) * 0.01).collect();
        let noise = |at: usize| (at * 7919 % 13) as f64 / 6.0 - 1.0;
        let swing = |time: f64| (std::f64::consts::TAU * time / 0.4).sin();
        let values: Vec<f64> = times.iter().enumerate().map(|(at, time)| swing(*time) + noise(at)).collect();
        for shortest in [0.1, 0.4] {
            let found = strongest_period(&times, &values, shortest).unwrap();
            assert!((found / 0.4 - 1.0).abs() < 0.02, "{shortest}: {found}");
        }
        assert_eq!(strongest_period(&times[..1], &values[..1], 0.4), None);
    }

    /// Four repetitions of a motion that is not a sine, and a chirp.
    #[test]
    fn a_motion_that_repeats_has_a_dominant_line() {
        let times: Vec<f64> = (0..2500).map(|at| f64::from(at) * 0.01).collect();
        let of = |motion: &dyn Fn(f64) -> f64| times.iter().map(|time| motion(*time)).collect::<Vec<f64>>();
        let repeated = of(&|time| (1.01 * time).sin() + 0.1 * (3.03 * time).cos());
        let found = dominant_frequency(&times, &repeated).unwrap();
        assert!((found - 1.01).abs() < 0.03, "{found}");
        assert!((share(&times, &repeated, 1.01) - 0.99).abs() < 0.02);
        assert!(share(&times, &repeated, 2.02) < 0.02);
        assert_eq!(dominant_frequency(&times, &of(&|time| ((1.0 + 0.3 * time) * time).sin())), None);
    }

    /// A sine of amplitude a that decays at a rate r, sampled n times a second, has n·a²/(4r) of squares.
    #[test]
    fn a_decaying_line_is_found_with_its_squares() {
        let (rate, frequency, amplitude, interval) = (0.8, 31.0, 2e-3, 0.01);
        let weight = |time: f64| (-rate * time).exp();
        let times: Vec<f64> = (0..2500).map(|at| f64::from(at) * interval).collect();
        let values: Vec<f64> =
            times.iter().map(|t| amplitude * weight(*t) * (frequency * t + 0.4).sin()).collect();
        let points: Vec<(f64, f64)> = times.iter().zip(&values).map(|(t, v)| (*t, weight(*t) * v)).collect();
        let squares = times.iter().map(|t| weight(*t).powi(2)).sum();
        let mut gains = vec![0.0; 400];
        add(&points, squares, 10.0, 0.1, &mut gains);
        let best = peaks(&gains, 10.0, 0.1, 1)[0];
        assert!((best.frequency - frequency).abs() < 0.11, "{best:?}");
        let expected = amplitude * amplitude / (4.0 * rate) / interval;
        assert!((best.gain / expected - 1.0).abs() < 0.05, "{} {expected}", best.gain);
        // A steady sine over the same 25 s explains a tenth of that.
        let plain: Vec<(f64, f64)> = times.iter().copied().zip(values).collect();
        let mut steady = vec![0.0; 400];
        add(&plain, plain.len() as f64, 10.0, 0.1, &mut steady);
        let share = peaks(&steady, 10.0, 0.1, 1)[0].gain / best.gain;
        assert!((share / (2.0 / (rate * 25.0)) - 1.0).abs() < 0.1, "{share}");
    }

    /// A chirp and noise hold every frequency, and a line at none.
    #[test]
    fn tells_a_line_from_a_chirp_and_from_noise() {
        use rand_distr::{Distribution, StandardNormal};
        let times: Vec<f64> = (0..2000).map(|at| 0.01 * f64::from(at)).collect();
        let tau = std::f64::consts::TAU;
        let lines: Vec<f64> = times.iter().map(|t| (tau * 0.9 * t).sin() + (tau * 2.1 * t).sin()).collect();
        let chirp: Vec<f64> = times.iter().map(|t| (tau * (0.2 + 0.2 * t) * t).sin()).collect();
        let generator = seed::Seed::new(2).child("noise").generator();
        let noise: Vec<f64> = StandardNormal.sample_iter(generator).take(2000).collect();
        let has = |values: &[f64], hertz: f64| super::has_line(&times, values, tau * hertz);
        assert!(has(&lines, 0.9) && has(&lines, 2.1) && !has(&lines, 1.4));
        for hertz in [0.9, 1.4, 2.1, 3.3] {
            assert!(!has(&chirp, hertz) && !has(&noise, hertz), "{hertz}");
        }
    }
}
