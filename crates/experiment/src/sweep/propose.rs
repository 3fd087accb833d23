//! Where a search tries next: random points, or points of a tree-structured Parzen estimator.
//!
//! Bergstra, Bardenet, Bengio, Kégl, Algorithms for Hyper-Parameter Optimization, NeurIPS 24 (2011) 2546, each key by
//! itself. Numbers are drawn in the unit interval of their scale.

use super::{Dimension, Domain, SweepError};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use seed::Seed;
use serde::{Deserialize, Serialize};

/// How a search chooses its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sampler {
    /// Independent draws, all known before the first run.
    Random,
    /// Draws from where the best results so far lie, by tree-structured Parzen estimators.
    Tpe,
}

/// A point that was tried: an override for each dimension, and what it cost.
#[derive(Debug, Clone, PartialEq)]
pub struct TriedPoint {
    /// An override for each dimension, in their order.
    pub overrides: Vec<String>,
    /// What is minimized; `None` where the run failed, which counts as worse than anything.
    pub cost: Option<f64>,
}

/// Points that [`Sampler::Tpe`] draws at random before it has anything to go by.
pub const STARTING_POINTS: usize = 10;

/// Draws after which a space counts as used up.
const MOST_DRAWS: usize = 1_000;

/// The next `count` points of a search, none of them tried before.
///
/// Point number k depends on the seed, on k, and on `tried` alone. Points of one call know of each other only that they
/// are taken, as if each were the worst so far ("constant liar"), so that they may run side by side.
///
/// # Errors
/// [`SweepError::UsedUp`] where the space has no more points.
pub fn propose(
    dimensions: &[Dimension],
    sampler: Sampler,
    seed: &Seed,
    tried: &[TriedPoint],
    count: usize,
) -> Result<Vec<Vec<String>>, SweepError> {
    let mut known = tried.to_vec();
    for number in tried.len()..tried.len() + count {
        let mut generator = seed.child("search").child(&number.to_string()).generator();
        let is_guided = sampler == Sampler::Tpe && number >= STARTING_POINTS && !tried.is_empty();
        let estimators = match is_guided {
            true => estimators(dimensions, &known),
            false => Vec::new(),
        };
        let is_new = |point: &Vec<String>| known.iter().all(|other| other.overrides != *point);
        let mut draw = |attempt: usize| -> Vec<String> {
            // Where estimators insist on what was tried, chance decides.
            let guided = is_guided && attempt < MOST_DRAWS / 2;
            let places = dimensions.iter().enumerate();
            places
                .map(|(at, dimension)| match estimators.get(at).filter(|_| guided) {
                    Some(estimator) => dimension.at(estimator.place(&mut generator)),
                    None => dimension.at(generator.random()),
                })
                .collect()
        };
        let point = (0..MOST_DRAWS).map(&mut draw).find(is_new);
        let overrides = point.ok_or(SweepError::UsedUp { points: known.len() })?;
        known.push(TriedPoint { overrides, cost: None });
    }
    Ok(known.into_iter().skip(tried.len()).map(|point| point.overrides).collect())
}

/// Share of the points that count as good.
const GOOD: f64 = 0.1;

/// Places drawn where the good points lie, of which the one is taken where they are densest against the others.
const CANDIDATES: usize = 24;

/// Where the good and the other points of one dimension lie.
struct Estimator {
    good: Density,
    others: Density,
}

impl Estimator {
    /// A place in the unit interval.
    fn place<R: Rng>(&self, generator: &mut R) -> f64 {
        let candidates = (0..CANDIDATES).map(|_| self.good.draw(generator));
        let rated = candidates.map(|place| (self.good.log(place) - self.others.log(place), place));
        // Without candidates, which there are, the middle.
        rated.max_by(|one, other| one.0.total_cmp(&other.0)).map_or(0.5, |(_, place)| place)
    }
}

/// One estimator for each dimension.
fn estimators(dimensions: &[Dimension], tried: &[TriedPoint]) -> Vec<Estimator> {
    let cost = |point: &&TriedPoint| point.cost.filter(|cost| !cost.is_nan()).unwrap_or(f64::INFINITY);
    let mut order: Vec<&TriedPoint> = tried.iter().collect();
    order.sort_by(|one, other| cost(one).total_cmp(&cost(other)));
    let (good, others) = order.split_at((GOOD * order.len() as f64).ceil() as usize);
    let make = |(at, dimension): (usize, &Dimension)| {
        let density = |points: &[&TriedPoint]| {
            let place = |point: &&TriedPoint| dimension.place(point.overrides.get(at)?);
            Density::of(&dimension.domain, points.iter().filter_map(place).collect())
        };
        Estimator { good: density(good), others: density(others) }
    };
    dimensions.iter().enumerate().map(make).collect()
}

/// A density over the unit interval, up to a factor.
enum Density {
    /// Normal kernels of a number: centers and widths.
    Kernels(Vec<(f64, f64)>),
    /// Weights of choices.
    Weights(Vec<f64>),
}

impl Density {
    /// Of places; with a wide kernel in the middle, and a count of one for each choice, as what is known before.
    fn of(domain: &Domain, mut places: Vec<f64>) -> Self {
        if let Domain::Choice(values) = domain {
            let mut weights = vec![1.0; values.len()];
            for place in places {
                if let Some(weight) = weights.get_mut((place * values.len() as f64) as usize) {
                    *weight += 1.0;
                }
            }
            return Self::Weights(weights);
        }
        places.push(0.5);
        places.sort_by(f64::total_cmp);
        let least = 1.0 / (1.0 + places.len() as f64).min(100.0);
        let (before, after) = (places.iter().copied(), places.iter().copied().skip(1));
        let (before, after) = (std::iter::once(0.0).chain(before), after.chain([1.0]));
        let widths = before.zip(after).zip(&places);
        // As wide as the way to the farther neighbor.
        let width = |((before, after), place): ((f64, f64), &f64)| (place - before).max(after - place);
        Self::Kernels(widths.map(|own| (*own.1, width(own).clamp(least, 1.0))).collect())
    }

    fn draw<R: Rng>(&self, generator: &mut R) -> f64 {
        match self {
            Self::Kernels(kernels) => {
                let mut draw = || {
                    let number = generator.random_range(0..kernels.len());
                    let standard: f64 = StandardNormal.sample(generator);
                    // Never without kernels; the middle is where nothing is known.
                    kernels.get(number).map_or(0.5, |(center, width)| center + width * standard)
                };
                let drawn = std::iter::repeat_with(&mut draw).take(MOST_DRAWS);
                // The middle, after draws that all fell outside: a kernel far beyond an end.
                drawn.into_iter().find(|place| (0.0..1.0).contains(place)).unwrap_or(0.5)
            }
            Self::Weights(weights) => {
                let mut left = generator.random::<f64>() * weights.iter().sum::<f64>();
                let passed = weights.iter().take_while(|weight| {
                    left -= **weight;
                    left >= 0.0
                });
                let number = passed.count().min(weights.len().saturating_sub(1));
                (number as f64 + 0.5) / weights.len() as f64
            }
        }
    }

    fn log(&self, place: f64) -> f64 {
        match self {
            Self::Kernels(kernels) => {
                let kernel =
                    |(center, width): &(f64, f64)| (-0.5 * ((place - center) / width).powi(2)).exp() / width;
                (kernels.iter().map(kernel).sum::<f64>() / kernels.len() as f64).ln()
            }
            Self::Weights(weights) => {
                // A place behind the last weight has none.
                let weight = weights.get((place * weights.len() as f64) as usize).copied().unwrap_or(0.0);
                (weight / weights.iter().sum::<f64>()).ln()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Dimension, Sampler, TriedPoint, propose};
    use seed::Seed;

    fn space(axes: &[&str]) -> Vec<Dimension> {
        axes.iter().map(|axis| Dimension::parse(axis).unwrap()).collect()
    }

    fn value(text: &str) -> f64 {
        text.split_once('=').unwrap().1.parse().unwrap()
    }

    /// The least cost that a search finds in so many trials, in batches.
    fn least(sampler: Sampler, seed: u64, trials: usize) -> f64 {
        let space = space(&["x={from=1e-4,to=1.0,scale='log'}", "y=-5.0..5.0", "z=a,b,c,d"]);
        let cost = |point: &[String]| {
            let choice = ["z=a", "z=b", "z=c", "z=d"].iter().position(|own| *own == point[2]).unwrap();
            (value(&point[0]).log10() + 3.0).powi(2) + (value(&point[1]) - 1.0).powi(2) + choice as f64
        };
        let mut tried: Vec<TriedPoint> = Vec::new();
        while tried.len() < trials {
            for overrides in propose(&space, sampler, &Seed::new(seed), &tried, 5).unwrap() {
                let cost = Some(cost(&overrides));
                tried.push(TriedPoint { overrides, cost });
            }
        }
        tried.iter().filter_map(|point| point.cost).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn estimators_find_more_than_chance_in_as_many_trials() {
        let mean = |sampler| (0..40).map(|seed| least(sampler, seed, 60)).sum::<f64>() / 40.0;
        let (guided, random) = (mean(Sampler::Tpe), mean(Sampler::Random));
        assert!(guided < 0.7 * random, "{guided} against {random}");
    }

    #[test]
    fn a_point_follows_from_seed_number_and_results() {
        let space = space(&["x=0.0..1.0", "y=1..9"]);
        let of = |sampler, seed, tried: &[TriedPoint], count| {
            propose(&space, sampler, &Seed::new(seed), tried, count).unwrap()
        };
        let all = of(Sampler::Random, 3, &[], 6);
        let tried: Vec<TriedPoint> =
            all.iter().take(4).map(|own| TriedPoint { overrides: own.clone(), cost: None }).collect();
        assert_eq!(of(Sampler::Random, 3, &tried, 2), all[4..]);
        assert_ne!(of(Sampler::Random, 4, &[], 6), all);
        let many = of(Sampler::Random, 3, &[], 20);
        let told = |worst: usize| -> Vec<TriedPoint> {
            let cost = |at: usize| (at != worst).then_some(at as f64);
            let point =
                |(at, own): (usize, &Vec<String>)| TriedPoint { overrides: own.clone(), cost: cost(at) };
            many.iter().enumerate().map(point).collect()
        };
        assert_eq!(of(Sampler::Tpe, 3, &told(0), 3), of(Sampler::Tpe, 3, &told(0), 3));
        assert_ne!(of(Sampler::Tpe, 3, &told(0), 3), of(Sampler::Tpe, 3, &told(19), 3));
    }

    #[test]
    fn a_small_space_is_tried_once_and_then_used_up() {
        let space = space(&["x=1..3", "y=a,b"]);
        for sampler in [Sampler::Random, Sampler::Tpe] {
            let mut all = propose(&space, sampler, &Seed::new(0), &[], 6).unwrap();
            all.sort();
            all.dedup();
            assert_eq!(all.len(), 6);
            let refused = propose(&space, sampler, &Seed::new(0), &[], 7).unwrap_err().to_string();
            assert!(refused.contains("6"), "{refused}");
        }
    }
}
