//! Effect of a sensor's steps on the noise floor.
//!
//! Rounding is not white: where the motion is slow, or crosses a whole number of steps from sample to sample,
//! neighbors are rounded alike, and second differences underestimate the error. By how much depends on the
//! motion and on the size of the noise beneath the steps. So the sensor is simulated: this motion, white
//! Gaussian noise, rounding.

use crate::noise::statistics::sixths;
use rand_distr::{Distribution, StandardNormal};
use seed::Seed;
use std::f64::consts::{PI, TAU};

/// Number of simulations of every sample.
const PLAYS: usize = 4;

/// Number of bisections of the noise's size: to 1 part in 4000 of the floor or the step, whichever is larger.
const BISECTIONS: usize = 12;

/// Mean square of noise and rounding, stored as its distance from that of the noise alone in the same draws:
/// most of the chance in the draws cancels.
#[derive(Debug, Clone, Copy, Default)]
struct Mean {
    beyond: f64,
    count: f64,
}

impl Mean {
    fn add(&mut self, square: f64, of_noise: f64) {
        self.beyond += square - of_noise;
        self.count += 1.0;
    }

    fn with(self, noise: f64) -> f64 {
        self.beyond / self.count.max(1.0) + noise * noise
    }
}

/// Readings that are rounded to whole steps, and the noise beneath the steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rounded {
    /// One of the values that a reading can have, and the distance to the next.
    lattice: f64,
    step: f64,
    /// Standard deviation of the noise beneath the steps.
    noise: f64,
    /// Mean square error of a sample over the mean of the [`sixths`].
    pub(crate) factor: f64,
}

/// Smallest noise beneath the steps, in steps, with which the mean of rounded readings is computed: the motion
/// is known no better.
const SHARPEST: f64 = 0.05;

/// Number of terms of the sawtooth's Fourier series; the last is smaller than 1e-8 of the first.
const TERMS: i32 = 20;

impl Rounded {
    /// Returns by how much the mean of readings is off at a position: the sawtooth of rounding, as a Fourier
    /// series, of which noise of standard deviation s damps the k-th term by exp(−2(πks/q)²).
    pub(crate) fn bias(&self, position: f64) -> f64 {
        let noise = (self.noise / self.step).max(SHARPEST);
        let phase = TAU * (position - self.lattice) / self.step;
        let term = |k: i32| {
            let order = f64::from(k);
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            sign / order * libm::exp(-2.0 * (PI * order * noise).powi(2)) * libm::sin(order * phase)
        };
        self.step / PI * (1..=TERMS).map(term).sum::<f64>()
    }
}

/// Returns what readings rounded to whole steps say of the noise beneath; `None` if they show no noise.
///
/// `pieces` are readings and their errors against the motion, piece by piece, all in the unit of `step`;
/// `measured` is the root of the mean sixth in these readings. The noise beneath the steps is assumed to be
/// white and Gaussian, with the size that gives this mean.
///
/// The draws are the nodes of an integral: they are the same in every call.
pub(crate) fn rounded(pieces: &[(&[f64], &[f64])], step: f64, measured: f64) -> Option<Rounded> {
    let lattice =
        pieces.iter().find_map(|(readings, _)| readings.first().copied()).filter(|_| measured > 0.0)?;
    let motions: Vec<Vec<f64>> = pieces
        .iter()
        .map(|(readings, errors)| readings.iter().zip(*errors).map(|(y, e)| y - e).collect())
        .collect();
    let mut generator = Seed::new(0).child("rounding").generator();
    let draws: Vec<Vec<f64>> = (0..PLAYS)
        .flat_map(|_| motions.iter().map(Vec::len).collect::<Vec<_>>())
        .map(|count| (0..count).map(|_| StandardNormal.sample(&mut generator)).collect())
        .collect();
    // Returns the mean square error, and the mean of the sixths.
    let play = |noise: f64| -> [f64; 2] {
        let (mut all, mut differences) = (Mean::default(), Mean::default());
        for (motion, draws) in motions.iter().cycle().zip(&draws) {
            let noises: Vec<f64> = draws.iter().map(|draw| noise * draw).collect();
            let readings: Vec<f64> = motion
                .iter()
                .zip(&noises)
                .map(|(x, e)| lattice + step * ((x + e - lattice) / step).round())
                .collect();
            let errors: Vec<f64> = readings.iter().zip(motion).map(|(y, x)| y - x).collect();
            for (error, noise) in errors.iter().zip(&noises) {
                all.add(error * error, noise * noise);
            }
            for pair in sixths(&errors).into_iter().zip(sixths(&noises)) {
                if let (Some(sixth), Some(of_noise)) = pair {
                    differences.add(sixth, of_noise);
                }
            }
        }
        [all.with(noise), differences.with(noise)]
    };
    // Rounding cannot hide noise of more than a step.
    let (mut low, mut high) = (0.0, measured.max(step));
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        let [_, sixths] = play(middle);
        if sixths < measured * measured { low = middle } else { high = middle }
    }
    let noise = 0.5 * (low + high);
    let [errors, sixths] = play(noise);
    let factor = if errors > 0.0 && sixths > 0.0 { errors / sixths } else { 1.0 };
    Some(Rounded { lattice, step, noise, factor })
}

#[cfg(test)]
mod tests {
    use super::{Rounded, rounded};
    use crate::noise::statistics::sixths;
    use rand_distr::{Distribution, StandardNormal};

    /// Rounded decaying swings: the error of a floor without the factor, and with it. Chance alone causes
    /// 1 %.
    #[test]
    fn a_floor_is_the_size_of_the_errors() {
        let mut worst: [f64; 2] = [0.0; 2];
        for (at, step) in [1.0, 3.0, 7.0].into_iter().enumerate() {
            let mut generator = seed::Seed::new(at as u64).child("noise").generator();
            let motion: Vec<f64> = (0..20_000)
                .map(|i| f64::from(i) / 260.0)
                .map(|t| 400.0 * (-0.15 * t).exp() * (12.0 * t).sin())
                .collect();
            let readings: Vec<f64> = motion
                .iter()
                .map(|x| {
                    let noise: f64 = StandardNormal.sample(&mut generator);
                    step * ((x + noise) / step).round()
                })
                .collect();
            let errors: Vec<f64> = readings.iter().zip(&motion).map(|(y, x)| y - x).collect();
            let own = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
            let own_sixths: Vec<f64> = sixths(&errors).into_iter().flatten().collect();
            let mean = own_sixths.iter().sum::<f64>() / own_sixths.len() as f64;
            let with = mean * rounded(&[(&readings, &errors)], step, mean.sqrt()).unwrap().factor;
            for (worst, floor) in worst.iter_mut().zip([mean, with]) {
                *worst = worst.max((floor / own - 1.0).abs());
            }
        }
        assert!(worst[0] > 0.05 && worst[1] < 0.03, "{worst:?}");
    }

    #[test]
    fn nothing_to_play_changes_nothing() {
        assert_eq!(rounded(&[], 1.0, 1.0), None);
        assert_eq!(rounded(&[(&[1.0; 9], &[0.0; 9])], 1.0, 0.0), None);
    }

    /// Means of 200,000 rounded readings scatter by 0.001 steps.
    #[test]
    fn the_mean_of_rounded_readings_is_off_as_stated() {
        let mut generator = seed::Seed::new(7).child("noise").generator();
        for noise in [0.06, 0.15, 0.4] {
            let own = Rounded { lattice: 0.3, step: 2.0, noise: 2.0 * noise, factor: 1.0 };
            for position in [0.3, 0.9, 1.2, 2.2] {
                let draws = (0..200_000).map(|_| -> f64 { StandardNormal.sample(&mut generator) });
                let readings = draws.map(|draw| {
                    let exact = position + 2.0 * noise * draw;
                    0.3 + 2.0 * ((exact - 0.3) / 2.0).round()
                });
                let mean = readings.sum::<f64>() / 200_000.0;
                assert!((own.bias(position) - (mean - position)).abs() < 0.01, "{noise} {position}");
            }
        }
    }
}
