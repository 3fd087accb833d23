//! Isolated wrong values, which are no turning points of a motion.

#![allow(clippy::indexing_slicing, reason = "every index is that of a value")]

use crate::statistics::noise_level;

/// Distance from what the neighbors lead to expect, in standard deviations of the noise, from which a value is wrong.
const FAR: f64 = 10.0;

/// The same in distances of the values around, by their upper fifth: a curve is as far from its chords at many samples.
const UNUSUAL: f64 = 6.0;

/// Number of values on either side whose distances are usual.
const AROUND: usize = 16;

/// Returns the values with straight lines in place of isolated wrong ones: those that contradict the line through the two
/// values before, the line through the two after, and the middle of the two beside them. The time is linear in the number
/// of values.
pub(crate) fn without_spikes(values: &[f64]) -> Vec<f64> {
    let far = FAR * noise_level(values);
    let distances: Vec<f64> = (0..values.len()).map(|at| distance(values, at)).collect();
    let is_wrong = |at: usize| {
        let own = distances[at];
        own > far && {
            let around = at.saturating_sub(AROUND)..(at + AROUND + 1).min(values.len());
            let mut around = distances[around].to_vec();
            around.sort_by(f64::total_cmp);
            own > UNUSUAL * around[4 * around.len() / 5]
        }
    };
    let right: Vec<usize> = (0..values.len()).filter(|at| !is_wrong(*at)).collect();
    let mut calm = values.to_vec();
    for pair in right.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        for (after, slot) in calm[from + 1..to].iter_mut().enumerate() {
            let share = (after + 1) as f64 / (to - from) as f64;
            *slot = values[from] + share * (values[to] - values[from]);
        }
    }
    calm
}

/// Returns the smallest distance of a value from what its neighbors lead to expect; 0 for the first and last two.
fn distance(values: &[f64], at: usize) -> f64 {
    let Some([a, b, own, c, d]) = at.checked_sub(2).and_then(|from| values.get(from..from + 5)) else {
        return 0.0;
    };
    [2.0 * b - a, 2.0 * c - d, 0.5 * (b + c)]
        .map(|expected| (own - expected).abs())
        .into_iter()
        .fold(f64::MAX, f64::min)
}

#[cfg(test)]
mod tests {
    use super::without_spikes;
    use rand::{RngExt, SeedableRng};
    use rand_distr::{Distribution, StandardNormal};

    fn swing(samples_per_period: f64, noise: f64) -> Vec<f64> {
        let mut draws = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let motion = |at: u32| {
            let angle = std::f64::consts::TAU * f64::from(at) / samples_per_period;
            (-0.02 * angle).exp() * angle.cos()
        };
        let mut value = |at: u32| {
            let draw: f64 = StandardNormal.sample(&mut draws);
            motion(at) + noise * draw
        };
        (0..2000).map(&mut value).collect()
    }

    #[test]
    fn wrong_values_are_replaced_alone_and_in_pairs() {
        let sound = swing(60.0, 0.005);
        let mut values = sound.clone();
        let mut draws = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let mut wrong: Vec<usize> = (0..40).map(|_| draws.random_range(10..1990)).collect();
        wrong.extend([301, 302, 901, 902]);
        wrong.iter().for_each(|at| values[*at] += 0.6);
        let calm = without_spikes(&values);
        for (at, (calm, sound)) in calm.iter().zip(&sound).enumerate() {
            assert!((calm - sound).abs() < 0.06, "{at}: {calm} for {sound}");
        }
    }

    #[test]
    fn a_motion_is_left_as_it_is() {
        for samples in [6.0, 8.0, 12.5, 31.0, 240.0] {
            for noise in [0.0, 1e-4, 0.02] {
                let values = swing(samples, noise);
                assert!(without_spikes(&values) == values, "{samples} {noise}");
            }
        }
    }

    #[test]
    fn a_step_and_a_short_series_are_left_as_they_are() {
        let step: Vec<f64> = (0..100).map(|at| if at < 50 { 0.0 } else { 1.0 }).collect();
        assert_eq!(without_spikes(&step), step);
        for count in 0..6 {
            let few = vec![1.0; count];
            assert_eq!(without_spikes(&few), few);
        }
    }
}
