//! Simulated envelopes that train an amortized network.

use crate::sequence::Sequence;
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;
use serde::Deserialize;

/// Prior over simulated envelopes: exponentials, some of them bent, with Gaussian scatter on ln A, at
/// slightly uneven times.
///
/// Ranges and defaults are in [`fields`](super::fields).
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Prior {
    /// Smallest and largest number of peaks; log-uniform.
    pub peaks: [usize; 2],
    /// Smallest and largest change of ln A over the envelope; log-uniform. Half of the envelopes grow.
    pub decay: [f64; 2],
    /// Smallest and largest standard deviation of ln A about the curve; log-uniform.
    pub scatter: [f64; 2],
    /// Largest standard deviation of a peak's time, in units of the interval; uniform from 0.
    pub unevenness: f64,
    /// Largest probability that a peak is missing; uniform from 0.
    pub missing: f64,
    /// Share of bent envelopes.
    pub bent: f64,
    /// Largest distance of a bent envelope from its chord, as a share of the decay; uniform, to either side.
    pub bend: f64,
}

/// Training example: the sequence shown to a network, and the line that it should return.
#[derive(Debug, Clone, PartialEq)]
pub struct Example {
    /// Sequence with mean 0 and standard deviation 1.
    pub sequence: Sequence,
    /// Level c and rate r of the true line z ≈ c − r·s, in the same units.
    pub line: [f64; 2],
}

/// Largest shift of a peak's time, in units of the interval; small enough to keep the peaks in order.
const LARGEST_SHIFT: f64 = 0.45;

/// One in this many examples is shown as at the first look, the others as at later looks.
const FIRST_LOOK_EVERY: usize = 4;

/// Largest error of the line at the start of a later look, in standard errors of the rate; drawn uniformly.
///
/// If large errors were less likely than small ones, the network would learn to stay near its current line
/// and to understate its error.
const LARGEST_MISS: f64 = 8.0;

/// Simulated envelope: a sequence in s and ln A, and the line closest to its noise-free curve.
struct Simulated {
    sequence: Sequence,
    line: [f64; 2],
    scatter: f64,
}

impl Prior {
    /// Draws examples of equal length, each with at most `longest` entries. Some are shown as at the first
    /// look; from most, a line near the true one has been subtracted, as at later looks.
    pub fn examples(&self, count: usize, longest: usize, generator: &mut impl Rng) -> Vec<Example> {
        let peaks = self.draw_peaks(generator);
        let examples = (0..count).map(|at| {
            let simulated = self.simulate(peaks, generator);
            let seen_from =
                if at % FIRST_LOOK_EVERY == 0 { [0.0; 2] } else { simulated.nearby_line(generator) };
            simulated.seen_from(seen_from, longest)
        });
        examples.collect()
    }

    /// Draws simulated envelopes of equal length, in s and ln A, each with level and rate of its true line.
    pub fn sequences(&self, count: usize, generator: &mut impl Rng) -> Vec<(Sequence, [f64; 2])> {
        let peaks = self.draw_peaks(generator);
        let simulated = (0..count).map(|_| self.simulate(peaks, generator));
        simulated.map(|simulated| (simulated.sequence, simulated.line)).collect()
    }

    /// Draws a number of peaks.
    fn draw_peaks(&self, generator: &mut impl Rng) -> usize {
        let [fewest, most] = self.peaks.map(|peaks| peaks as f64);
        // Half a peak on either side gives both endpoints their full share.
        let drawn = log_uniform([fewest - 0.5, most + 0.5], generator).round();
        drawn.clamp(fewest, most) as usize
    }

    fn simulate(&self, peaks: usize, generator: &mut impl Rng) -> Simulated {
        let times = self.draw_times(peaks, generator);
        let growth = if generator.random::<bool>() { 1.0 } else { -1.0 };
        let change = growth * log_uniform(self.decay, generator);
        let scatter = log_uniform(self.scatter, generator);
        let bends = generator.random::<f64>() < self.bent;
        let bend = if bends { Bend::draw(self.bend, generator) } else { Bend::NONE };
        let curve: Vec<f64> = times.iter().map(|&s| change * (s / 2.0 + bend.off_chord(s))).collect();
        let line = closest_line(&times, &curve);
        let values =
            curve.iter().map(|value| value + scatter * generator.sample::<f64, _>(StandardNormal)).collect();
        Simulated { sequence: Sequence { times, values }, line, scatter }
    }

    /// Draws the times of the peaks, from −1 to 1.
    fn draw_times(&self, peaks: usize, generator: &mut impl Rng) -> Vec<f64> {
        let missing = self.missing * generator.random::<f64>();
        let unevenness = self.unevenness * generator.random::<f64>();
        let mut place = 0.0;
        let mut times = Vec::with_capacity(peaks);
        for _ in 0..peaks {
            let shift = unevenness * generator.sample::<f64, _>(StandardNormal);
            times.push(place + shift.clamp(-LARGEST_SHIFT, LARGEST_SHIFT));
            place += 1.0;
            while generator.random::<f64>() < missing {
                place += 1.0;
            }
        }
        let [first, .., last] = *times else { return times };
        times.iter().map(|time| 2.0 * (time - first) / (last - first) - 1.0).collect()
    }
}

impl Simulated {
    /// Draws a line that a reader may have after some looks: the true line with a rate that is off by some
    /// standard errors.
    fn nearby_line(&self, generator: &mut impl Rng) -> [f64; 2] {
        let std_error = self.scatter * (3.0 / self.sequence.len() as f64).sqrt();
        let missed = std_error * LARGEST_MISS * generator.random_range(-1.0..=1.0);
        let [level, rate] = self.line;
        [level, rate + missed]
    }

    /// Returns the example that a reader sees after subtracting a line.
    fn seen_from(mut self, [level, rate]: [f64; 2], longest: usize) -> Example {
        for (s, value) in self.sequence.times.iter().zip(&mut self.sequence.values) {
            *value -= level - rate * s;
        }
        let standard = Standardized::of(self.sequence, longest);
        let [true_level, true_rate] = self.line;
        let left = [true_level - level, true_rate - rate];
        Example { line: standard.scaled(left), sequence: standard.sequence }
    }
}

/// Deviation of a curve from its chord, as uᵖ deviates from u, where u is the elapsed or the remaining share
/// of the record.
///
/// p = 2 is a parabola, the first-order effect of a damping that falls with the amplitude. A large p is
/// nearly straight and drops steeply at one end, as dry friction makes ln A do before the oscillator comes to
/// rest.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bend {
    /// Largest distance from the chord, as a share of the decay; of either sign.
    size: f64,
    power: f64,
    /// `true` if u is the remaining share, `false` if it is the elapsed share.
    early: bool,
}

/// Smallest and largest power p of a bend.
const POWERS: [f64; 2] = [2.0, 8.0];

impl Bend {
    const NONE: Self = Self { size: 0.0, power: 2.0, early: false };

    fn draw(largest: f64, generator: &mut impl Rng) -> Self {
        let size = largest * generator.random_range(-1.0..=1.0);
        Self { size, power: log_uniform(POWERS, generator), early: generator.random() }
    }

    /// Returns the distance from the chord at s, as a share of the decay.
    fn off_chord(self, s: f64) -> f64 {
        let u = if self.early { (1.0 - s) / 2.0 } else { (1.0 + s) / 2.0 };
        // u − uᵖ is largest at u = p^(−1/(p − 1)).
        let farthest = self.power.powf(-1.0 / (self.power - 1.0));
        self.size * (u - u.powf(self.power)) / (farthest - farthest.powf(self.power))
    }
}

/// Sequence standardized to mean 0 and standard deviation 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Standardized {
    pub(super) sequence: Sequence,
    /// Mean that was subtracted.
    pub(super) mean: f64,
    /// Standard deviation of the original values; 0 if all are equal, and the standardized values are 0 then.
    pub(super) spread: f64,
}

impl Standardized {
    /// Standardizes a sequence and pools it to at most `longest` entries.
    ///
    /// The entries of a longer sequence are means over runs of neighbors. All runs have nearly the same
    /// length, because the network treats all entries as equally accurate.
    pub(super) fn of(sequence: Sequence, longest: usize) -> Self {
        let peaks_in_run = sequence.len().div_ceil(longest.max(1));
        let runs = sequence.len() / peaks_in_run.max(1);
        let mut sequence = sequence.pooled(runs);
        let count = sequence.len() as f64;
        let mean = sequence.values.iter().sum::<f64>() / count;
        let square = sequence.values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
        let spread = square.sqrt();
        for value in &mut sequence.values {
            *value = if spread > 0.0 { (*value - mean) / spread } else { 0.0 };
        }
        Self { sequence, mean, spread }
    }

    /// Converts level and rate of a line to the standardized units.
    fn scaled(&self, [level, rate]: [f64; 2]) -> [f64; 2] {
        [(level - self.mean) / self.spread, rate / self.spread]
    }
}

fn log_uniform([least, most]: [f64; 2], generator: &mut impl Rng) -> f64 {
    least * (most / least).powf(generator.random::<f64>())
}

/// Returns level and rate of the line z ≈ c − r·s closest to a curve at given times. For the noise-free curve
/// of a simulated envelope, this line defines λ even if the envelope bends.
fn closest_line(times: &[f64], curve: &[f64]) -> [f64; 2] {
    let count = times.len() as f64;
    let (middle, mean) = (times.iter().sum::<f64>() / count, curve.iter().sum::<f64>() / count);
    let along: f64 = times.iter().zip(curve).map(|(s, z)| (s - middle) * (z - mean)).sum();
    let square: f64 = times.iter().map(|s| (s - middle).powi(2)).sum();
    let rate = -along / square;
    [mean + rate * middle, rate]
}

#[cfg(test)]
mod tests {
    use super::{Bend, Prior, closest_line};
    use crate::amortized::tiny::prior;
    use crate::sequence::Sequence;
    use rand::SeedableRng;
    use rand::rngs::StdRng;

    fn generator() -> StdRng {
        StdRng::seed_from_u64(3)
    }

    /// Returns the share of entries that satisfy a condition.
    fn share<T>(entries: &[T], holds: impl Fn(&T) -> bool) -> f64 {
        entries.iter().filter(|entry| holds(entry)).count() as f64 / entries.len() as f64
    }

    #[test]
    fn envelopes_are_drawn_as_it_is_said() {
        let (prior, mut generator) = (prior(), generator());
        // One envelope of each batch, so that the numbers of peaks are independent.
        let simulated: Vec<_> = (0..4000)
            .map(|_| {
                let peaks = prior.draw_peaks(&mut generator);
                prior.simulate(peaks, &mut generator)
            })
            .collect();
        // Half lie below the geometric mean of the endpoints: of 4000, ± 0.8 %; the bounds are five standard
        // deviations away.
        let median = |below: f64| assert!((below - 0.5).abs() < 0.04, "{below}");
        median(share(&simulated, |one| one.sequence.len() as f64 <= (9.5_f64 * 400.5).sqrt()));
        median(share(&simulated, |one| one.scatter <= (0.003_f64 * 0.3).sqrt()));
        median(share(&simulated, |one| one.line[1] > 0.0));
        // The change over s from −1 to 1 is twice the rate; bends shift the line by less than that.
        median(share(&simulated, |one| 2.0 * one.line[1].abs() <= (0.3_f64 * 8.0).sqrt()));
        for one in &simulated {
            assert!((10..=400).contains(&one.sequence.len()) && (0.003..=0.3).contains(&one.scatter));
            let times = &one.sequence.times;
            assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
            assert!(times[0] == -1.0 && (times[times.len() - 1] - 1.0).abs() < 1e-15);
        }
        let peaks = |at: usize| share(&simulated, |one| one.sequence.len() == at);
        assert!(peaks(10) > 0.005, "the ends are drawn too: {}", peaks(10));
    }

    #[test]
    fn scatter_and_bend_have_their_sizes() {
        let straight = Prior { bent: 0.0, peaks: [400, 400], scatter: [0.05, 0.05], ..prior() };
        for (sequence, [level, rate]) in straight.sequences(20, &mut generator()) {
            let pairs = sequence.times.iter().zip(&sequence.values);
            let squares: f64 = pairs.map(|(s, z)| (z - (level - rate * s)).powi(2)).sum();
            // χ² with 400 degrees of freedom: 0.05 ± 3.5 %.
            assert!(((squares / 400.0).sqrt() / 0.05 - 1.0).abs() < 0.18, "{squares}");
        }
        let bent = Prior { bent: 1.0, scatter: [1e-9, 1e-9], decay: [2.0, 2.0], ..straight };
        let distances: Vec<f64> = bent
            .sequences(400, &mut generator())
            .iter()
            .map(|(Sequence { times, values }, _)| {
                let (first, last) = (values[0], values[399]);
                let chord = |s: &f64| first + (last - first) * (s + 1.0) / 2.0;
                times.iter().zip(values).map(|(s, z)| (z - chord(s)).abs()).fold(0.0, f64::max)
            })
            .collect();
        // Uniform from 0 to 0.1·2.
        assert!(distances.iter().all(|distance| *distance < 0.2 + 1e-6));
        let half = share(&distances, |distance| *distance < 0.1);
        assert!((half - 0.5).abs() < 0.125, "{half}");
    }

    #[test]
    fn a_bend_leaves_its_chord_at_neither_end_and_goes_as_far_as_it_says() {
        for (power, farthest) in [(2.0, 0.5), (8.0, 8_f64.powf(-1.0 / 7.0))] {
            for early in [false, true] {
                let bend = Bend { size: -0.3, power, early };
                assert!(bend.off_chord(-1.0).abs() < 1e-15 && bend.off_chord(1.0).abs() < 1e-15);
                let u: f64 = if early { 1.0 - farthest } else { farthest };
                assert!((bend.off_chord(2.0 * u - 1.0) + 0.3).abs() < 1e-14);
                let within =
                    (0..=200).all(|at| bend.off_chord(f64::from(at) / 100.0 - 1.0).abs() < 0.3 + 1e-14);
                assert!(within);
            }
        }
    }

    #[test]
    fn an_example_is_of_mean_0_and_spread_1_and_its_line_lies_behind_it() {
        let clean = Prior { bent: 0.0, scatter: [1e-9, 1e-9], ..prior() };
        for example in clean.examples(50, 24, &mut generator()) {
            let Sequence { times, values } = &example.sequence;
            let count = values.len() as f64;
            assert!((10..=24).contains(&values.len()));
            assert!((values.iter().sum::<f64>() / count).abs() < 1e-6);
            assert!((values.iter().map(|z| z * z).sum::<f64>() / count - 1.0).abs() < 1e-9);
            let [level, rate] = example.line;
            // The residual at a later look is as small as the scatter, so only first looks are free of noise.
            if (rate.abs() - 3_f64.sqrt()).abs() < 0.1 {
                let miss = times.iter().zip(values).map(|(s, z)| (z - (level - rate * s)).abs());
                assert!(miss.fold(0.0, f64::max) < 3.0);
            }
        }
        let clean = clean.examples(1, 24, &mut generator()).remove(0);
        let [level, rate] = clean.line;
        for (s, z) in clean.sequence.times.iter().zip(&clean.sequence.values) {
            assert!((z - (level - rate * s)).abs() < 1e-6, "{z}");
        }
    }

    #[test]
    fn the_same_generator_draws_the_same_and_goes_on() {
        let prior = prior();
        assert_eq!(prior.examples(5, 24, &mut generator()), prior.examples(5, 24, &mut generator()));
        let mut generator = generator();
        assert_ne!(prior.examples(5, 24, &mut generator), prior.examples(5, 24, &mut generator));
    }

    #[test]
    fn runs_of_a_long_envelope_are_as_long_as_each_other() {
        let prior = Prior { peaks: [69, 69], ..prior() };
        // 69 peaks in at most 24 entries: three peaks per entry.
        assert_eq!(prior.examples(2, 24, &mut generator())[0].sequence.len(), 23);
    }

    #[test]
    fn the_closest_line_leaves_what_is_orthogonal_to_lines() {
        let times = [-1.0, -0.7, 0.1, 0.3, 1.0];
        let curve = times.map(|s: f64| 3.0 - 2.0 * s + 0.7 * s * s);
        let [level, rate] = closest_line(&times, &curve);
        let left: Vec<f64> = times.iter().zip(&curve).map(|(s, z)| z - (level - rate * s)).collect();
        assert!(left.iter().sum::<f64>().abs() < 1e-14);
        assert!(times.iter().zip(&left).map(|(s, left)| s * left).sum::<f64>().abs() < 1e-14);
        let [level, rate] = closest_line(&times, &times.map(|s| 3.0 - 2.0 * s));
        assert!((level - 3.0).abs() < 1e-14 && (rate - 2.0).abs() < 1e-14);
    }
}
