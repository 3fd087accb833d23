//! Detection of isolated wrong samples by comparison with the samples around them.

#![allow(
    clippy::indexing_slicing,
    reason = "there is a distance for every sample, and a block for every distance"
)]

use crate::data::observations::Observations;
use crate::measurement::neighbors::{Distance, OF_MEDIAN, distances, interval, points};
use crate::measurement::stale::stale;
use crate::noise::statistics::{median, normal_above};

/// Probability that Gaussian noise alone produces an outlier in a record.
const FALSE_ALARM: f64 = 1e-3;

/// Number of samples that share a noise scale with their neighbors: noise may grow with speed, and a fast
/// mode may ring down.
const BLOCK: usize = 64;

/// Largest ratio of the distance at double spacing to that at single spacing. For a wrong sample both are
/// equal (1); for a bend of the motion the ratio is 2, for a curve more.
const BEND: f64 = 1.35;

/// Least ratio of the distance at double spacing, and of that from a parabola through three neighbors, to the distance from
/// the cubic through all four. For a wrong sample all are equal (1); beside one, the parabola without it is met (0), between
/// two the cubic at double spacing (0); beside a step or two wrong samples the parabola's ratio is 1/3.
const ALONE: f64 = 0.5;

/// Largest number of samples from a wrong sample to another that hides it, and the number on either side of a sample by which
/// it is compared where that one is left out.
const REACH: usize = 3;
const BESIDE: usize = 6;

/// Share of outliers beyond which they are no exceptions, and the number of standard deviations of a count by
/// which it must be exceeded, since a larger share of few samples may be wrong by chance.
const MOST: f64 = 0.02;
const BY_CHANCE: f64 = 3.0;

/// Maximum number of rounds, because a wrong sample hides another within its neighborhood.
const ROUNDS: usize = 3;

/// Marks the samples to keep. Stale readings, and isolated samples that the motion around them does not support,
/// are left out of every fit.
///
/// A sample is compared with the cubic through its four neighbors, at the times of the chosen clock, in units
/// of the noise of that distance. The noise is the median absolute distance (times 1.4826, the Gaussian's
/// ratio) of the whole record, or of the samples around if that is larger; for a sensor with steps it is at
/// least the rounding of a step. A sample is wrong if the distance exceeds the limit that any of all samples
/// reaches by chance with a probability of 0.001, plus the largest distance that rounding can add. It also
/// has to be isolated: bends (end stops, reversals under friction) grow with the spacing of the neighbors,
/// and a sample beside a step lies near a parabola through three of them. Of two neighboring wrong samples, each
/// hides the other, and both are compared with the samples around the pair.
///
/// If bursts have lost samples, the places of samples within a burst are guesses, and no sample is called
/// wrong.
///
/// The time is linear in the number of samples.
pub(crate) fn kept(observations: &Observations) -> Vec<bool> {
    let everything: Vec<bool> = stale(observations).iter().map(|stale| !stale).collect();
    if observations.stamps.repeated > 0 && observations.stamps.lost > 0 {
        return everything;
    }
    let mut kept = everything.clone();
    for _ in 0..ROUNDS {
        let wrong = wrong(observations, &kept);
        for &at in &wrong {
            if let Some(slot) = kept.get_mut(at) {
                *slot = false;
            }
        }
        if wrong.is_empty() {
            break;
        }
    }
    let dropped = kept.iter().zip(&everything).filter(|(kept, fresh)| **fresh && !**kept).count() as f64;
    let most = MOST * observations.len() as f64;
    if dropped > most + BY_CHANCE * most.sqrt() { everything } else { kept }
}

/// Returns the indices of further wrong samples, given the samples that are still kept: those that are wrong beside all others,
/// and pairs of which each is wrong where the other is left out, since a wrong neighbor hides a wrong sample.
fn wrong(observations: &Observations, kept: &[bool]) -> Vec<usize> {
    let points = points(observations, kept);
    let interval = interval(observations);
    let near = distances(&points, 1, interval);
    let far = distances(&points, 2, interval);
    let limits = Limits::new(&near, observations.step());
    let outlying: Vec<usize> = (0..near.len()).filter(|at| limits.outlying(&near, *at, *at)).collect();
    let mut wrong: Vec<usize> =
        outlying.iter().copied().filter(|at| limits.isolated(&near, &far, *at)).collect();
    for one in outlying {
        // The other one may lie on the cubic through its neighbors, of which the first is one.
        let beside = one.saturating_sub(REACH)..(one + REACH + 1).min(points.len());
        for other in beside.filter(|other| *other != one) {
            let wrong_without = |own: usize, other: usize| {
                let from = own.saturating_sub(BESIDE);
                let window = from..(own + BESIDE + 1).min(points.len());
                let beside: Vec<_> = window.filter(|at| *at != other).map(|at| points[at]).collect();
                let at = own - from - usize::from(other < own);
                let (near, far) = (distances(&beside, 1, interval), distances(&beside, 2, interval));
                limits.outlying(&near, at, own) && limits.isolated(&near, &far, at)
            };
            if wrong_without(one, other) && wrong_without(other, one) {
                wrong.extend([one, other]);
            }
        }
    }
    wrong.into_iter().map(|at| points[at].0).collect()
}

/// Scales of the distances in a record.
struct Limits {
    /// Number of standard deviations of a distance that noise reaches by chance.
    deviations: f64,
    step: f64,
    /// Standard deviation of the noise in the whole record and by block.
    whole: f64,
    blocks: Vec<f64>,
}

impl Limits {
    fn new(near: &[Option<Distance>], step: f64) -> Self {
        let of = |distances: &[Option<Distance>]| {
            OF_MEDIAN * median(&distances.iter().flatten().map(Distance::in_noise).collect::<Vec<_>>())
        };
        Self {
            deviations: normal_above(0.5 * FALSE_ALARM / near.len().max(1) as f64),
            step,
            whole: of(near).max(step / 12.0_f64.sqrt()),
            blocks: near.chunks(BLOCK).map(of).collect(),
        }
    }

    /// Returns the standard deviation of the noise around a sample of the record.
    fn around(&self, sample: usize) -> f64 {
        let block = sample / BLOCK;
        let own = &self.blocks[block.saturating_sub(1)..(block + 2).min(self.blocks.len())];
        own.iter().copied().fold(self.whole, f64::max)
    }

    /// Returns whether the distance `at` an index is larger than noise and rounding make it at a sample.
    fn outlying(&self, near: &[Option<Distance>], at: usize, sample: usize) -> bool {
        near[at].is_some_and(|own| {
            own.value.abs() > self.deviations * self.around(sample) * own.spread + own.rounding * self.step
        })
    }

    /// Returns whether the distance at an index neither grows with the spacing nor comes from a neighbor.
    fn isolated(&self, near: &[Option<Distance>], far: &[Option<Distance>], at: usize) -> bool {
        let (Some(own), Some(far)) = (near[at], far[at]) else { return false };
        let straight = far.value * own.value > ALONE * own.value * own.value
            && far.value.abs() < BEND * own.value.abs() + far.rounding.max(own.rounding) * self.step;
        straight && own.parabola_distance() > ALONE * own.value.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::kept;
    use crate::Observations;
    use crate::measurement::neighbors::white_noise;
    use dynamics::reference::{Tolerance, simulate};
    use dynamics::{Active, Nominal, Start, System};
    use rand::RngExt;
    use rand_distr::{Distribution, StandardNormal};
    use record::{Clock, ClockChoice, Quantity, Record};
    use seed::Seed;

    const NOISE: f64 = 1e-3;

    fn observed(times: Vec<f64>, values: Vec<f64>) -> Observations {
        let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
        Observations::new(&record, &Clock::new(&record, ClockChoice::Auto).unwrap())
    }

    fn even(count: usize) -> Vec<f64> {
        (0..count).map(|index| (index as f64 / 260.0 * 1e6).round() / 1e6).collect()
    }

    fn swing(time: f64) -> f64 {
        0.7 * (-0.2 * time).exp() * (30.0 * time).cos()
    }

    fn normal(count: usize, seed: u64) -> Vec<f64> {
        let mut generator = Seed::new(seed).child("noise").generator();
        (0..count).map(|_| NOISE * generator.sample::<f64, _>(StandardNormal)).collect()
    }

    fn named(times: Vec<f64>, values: Vec<f64>) -> usize {
        kept(&observed(times, values)).iter().filter(|kept| !**kept).count()
    }

    /// By design 0.001 of all records; the expectation is 0.4, and more than 3 occur by chance once in a
    /// thousand times.
    #[test]
    fn noise_alone_has_none() {
        let mut records = 0;
        for seed in 0..400 {
            let times = even(1000);
            let values =
                times.iter().zip(normal(1000, seed)).map(|(time, noise)| swing(*time) + noise).collect();
            records += usize::from(named(times, values) > 0);
        }
        assert!(records <= 3, "{records} of 400");
    }

    #[test]
    fn correlated_noise_has_none() {
        for (seed, keep) in [(1, 0.5), (2, 0.9), (3, 0.99), (4, -0.5)] {
            let times = even(6500);
            let mut state = 0.0;
            let values = times.iter().zip(normal(6500, seed)).map(|(time, noise)| {
                state = keep * state + noise;
                swing(*time) + state
            });
            assert_eq!(named(times.clone(), values.collect()), 0, "{keep}");
        }
    }

    /// Steps from far below the noise to far above it, up to a motion that ends within a step.
    #[test]
    fn rounding_has_none() {
        for (seed, part) in [0.1, 0.7, 1.0, 2.0, 3.0, 5.0, 20.0].into_iter().enumerate() {
            let step = part * NOISE;
            let times = even(6500);
            let values = times.iter().zip(normal(6500, seed as u64));
            let values = values.map(|(time, noise)| ((swing(*time) + noise) / step).round() * step).collect();
            assert_eq!(named(times, values), 0, "{part}");
        }
    }

    /// Stops from soft to so hard that they bend the motion within a sample; friction that reverses and
    /// sticks.
    #[test]
    fn bends_are_none() {
        let omega: f64 = 20.0;
        let nominal = Nominal::new(1.0, 0.01 * omega, omega * omega, 0.0).unwrap();
        let hardness = [1.0, 10.0, 100.0, 1000.0, 10_000.0]
            .map(|hard| ("end_stop", vec![0.4, hard * omega * omega, 0.0]));
        let friction = [0.5, 2.0, 8.0].map(|torque| ("coulomb_friction", vec![torque]));
        for (id, values) in hardness.into_iter().chain(friction) {
            let system = System::new(nominal, vec![Active::new(id, &values).unwrap()]).unwrap();
            let times = even(4000);
            let motion =
                simulate(&system, Start::release(-0.6), None, &times, &Tolerance::default()).unwrap();
            for seed in 0..3 {
                let noisy = motion.position.iter().zip(normal(4000, seed)).map(|(x, noise)| x + 0.3 * noise);
                assert_eq!(named(times.clone(), noisy.collect()), 0, "{id} {values:?}");
            }
        }
    }

    /// Samples lost in stretches, single stamps rounded: a sample beyond a gap is no neighbor.
    #[test]
    fn gaps_and_scattered_stamps_make_none() {
        for (seed, stretch) in [1, 2, 4, 8].into_iter().enumerate() {
            let noise = normal(6500, seed as u64);
            let jitter = normal(6500, 100 + seed as u64);
            for scatter in [0.0, 0.05, 0.3] {
                let kept = (0..6500).filter(|index| index % 61 >= stretch);
                let samples = kept.map(|index| {
                    let time = index as f64 / 260.0;
                    (((time + scatter * jitter[index]) * 1e6).round() / 1e6, swing(time) + noise[index])
                });
                let (mut times, values): (Vec<f64>, Vec<f64>) = samples.unzip();
                times.sort_by(f64::total_cmp);
                assert_eq!(named(times, values), 0, "{stretch} {scatter}");
            }
        }
    }

    /// One sample of a hundred is wrong by ten times the noise. For 6500 samples the limit lies at 5.3
    /// standard deviations of a distance, 7.3 times the noise. A sample is never marked because of its
    /// neighbor's error.
    #[test]
    fn wrong_samples_are_found_and_no_others() {
        let times = even(6500);
        let mut generator = Seed::new(5).child("wrong").generator();
        let errors: Vec<f64> = (0..6500)
            .map(|_| {
                let error: f64 = StandardNormal.sample(&mut generator);
                if generator.random::<f64>() < 0.01 { 10.0 * NOISE * error } else { 0.0 }
            })
            .collect();
        let noise = normal(6500, 6);
        let values =
            times.iter().zip(&errors).zip(&noise).map(|((t, error), noise)| swing(*t) + error + noise);
        let kept = kept(&observed(times.clone(), values.collect()));
        let large = errors.iter().filter(|error| error.abs() > 10.0 * NOISE).count();
        let found =
            errors.iter().zip(&kept).filter(|(error, kept)| error.abs() > 10.0 * NOISE && !**kept).count();
        let blamed =
            errors.iter().zip(&kept).filter(|(error, kept)| error.abs() < 2.0 * NOISE && !**kept).count();
        assert!(found as f64 >= 0.9 * large as f64, "{found} of {large}");
        assert_eq!(blamed, 0);
    }

    /// Errors of 60 and of 40 times the noise in two samples next to each other or with one or two between, of equal and of
    /// opposite sign.
    #[test]
    fn wrong_samples_in_pairs_are_found_and_none_between() {
        let times = even(6500);
        let noise = normal(6500, 9);
        let starts: Vec<usize> = (100..6400).step_by(397).collect();
        for (apart, sign) in [(1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0), (3, 1.0), (3, -1.0)] {
            let mut values: Vec<f64> = times.iter().zip(&noise).map(|(t, noise)| swing(*t) + noise).collect();
            for start in &starts {
                values[*start] += 60.0 * NOISE;
                values[start + apart] += sign * 40.0 * NOISE;
            }
            let kept = kept(&observed(times.clone(), values));
            let left_out: Vec<usize> = (0..6500).filter(|at| !kept[*at]).collect();
            let wrong: Vec<usize> = starts.iter().flat_map(|start| [*start, start + apart]).collect();
            assert_eq!(left_out, wrong, "{apart} {sign}");
        }
    }

    #[test]
    fn wrong_samples_at_the_ends_of_a_record_are_found() {
        let times = even(6500);
        let noise = normal(6500, 10);
        for ends in [[0, 6499], [1, 6498], [2, 6497]] {
            let mut values: Vec<f64> = times.iter().zip(&noise).map(|(t, noise)| swing(*t) + noise).collect();
            ends.iter().for_each(|at| values[*at] -= 100.0 * NOISE);
            let kept = kept(&observed(times.clone(), values));
            assert_eq!((0..6500).filter(|at| !kept[*at]).collect::<Vec<_>>(), ends);
        }
    }

    /// At a share of one in fifty, seven of 250 samples are wrong by chance; thirty are no exceptions.
    #[test]
    fn of_few_samples_more_may_be_wrong() {
        let times = even(250);
        for (every, found) in [(35, 7), (8, 0)] {
            let noise = normal(250, 8);
            let wrong = |at: usize| if at % every == 5 { 60.0 * NOISE } else { 0.0 };
            let values = times.iter().zip(noise).enumerate();
            let values = values.map(|(at, (time, noise))| swing(*time) + noise + wrong(at)).collect();
            assert_eq!(named(times.clone(), values), found, "{every}");
        }
    }

    #[test]
    fn the_noise_of_a_swing() {
        let times = even(6500);
        let values = times.iter().zip(normal(6500, 7)).map(|(time, noise)| swing(*time) + noise).collect();
        let found = white_noise(&observed(times, values), &[true; 6500]);
        assert!((found / NOISE - 1.0).abs() < 0.05, "{found}");
    }

    /// Most neighbors agree, and the median distance is zero.
    #[test]
    fn the_noise_of_coarse_steps_is_their_rounding() {
        let times = even(6500);
        let step = 0.02;
        let values = times.iter().map(|time| (swing(*time) / step).round() * step).collect();
        let found = white_noise(&observed(times, values), &[true; 6500]);
        assert!((found / (step / 12.0_f64.sqrt()) - 1.0).abs() < 1e-9, "{found}");
    }
}
