//! Proposal of a search's next points: at random, or by a tree-structured Parzen estimator.
//!
//! Bergstra, Bardenet, Bengio, Kégl, Algorithms for Hyper-Parameter Optimization, NeurIPS 24 (2011) 2546,
//! applied to each key separately. Numbers are drawn in the unit interval of their scale.

#![allow(clippy::indexing_slicing, reason = "a number is drawn among the kernels")]

use super::{Dimension, Domain, SweepError};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use seed::Seed;
use serde::{Deserialize, Serialize};

/// Method for choosing the next points of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sampler {
    /// Independent random draws; all are known before the first run.
    Random,
    /// Draws near the best results so far, by tree-structured Parzen estimators.
    Tpe,
}

/// A point already tried and its cost.
#[derive(Debug, Clone, PartialEq)]
pub struct TriedPoint {
    /// Overrides of the point, one per dimension, in the order of the dimensions.
    pub overrides: Vec<String>,
    /// Cost to minimize; `None` if the run failed, which ranks below every other cost.
    pub cost: Option<f64>,
}

/// Number of points that [`Sampler::Tpe`] draws at random before it uses results.
pub const STARTING_POINTS: usize = 10;

/// Number of failed draws after which a space counts as exhausted.
const MOST_DRAWS: usize = 1_000;

/// Proposes the next `count` points of a search; none has been tried before.
///
/// Point number k depends only on the seed, on k and on `tried`. The points of one call can run in parallel:
/// each treats the others as tried with the worst cost ("constant liar").
///
/// # Errors
/// [`SweepError::UsedUp`] if the space has no more points.
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
            // If the estimators keep proposing tried points, the second half of the draws is random.
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

/// Share of the tried points that count as good.
const GOOD: f64 = 0.1;

/// Number of candidates drawn from the density of the good points; the one with the largest density ratio of
/// good to other points is chosen.
const CANDIDATES: usize = 24;

/// Place that is proposed if every draw fell outside the interval, as with a kernel far beyond an endpoint.
const MIDDLE: f64 = 0.5;

/// Densities of the good points and of the others, along one dimension.
struct Estimator {
    good: Density,
    others: Density,
}

impl Estimator {
    /// Draws a place in the unit interval.
    fn place<R: Rng>(&self, generator: &mut R) -> f64 {
        let mut rated = || {
            let place = self.good.draw(generator);
            (self.good.log(place) - self.others.log(place), place)
        };
        let mut best = rated();
        for _ in 1..CANDIDATES {
            let next = rated();
            if next.0.total_cmp(&best.0).is_ge() {
                best = next;
            }
        }
        best.1
    }
}

/// Returns one estimator per dimension.
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

/// Unnormalized density over the unit interval.
enum Density {
    /// Normal kernels of a numeric dimension, as (center, width).
    Kernels(Vec<(f64, f64)>),
    /// Weights of the choices.
    Weights(Vec<f64>),
}

impl Density {
    /// Estimates the density of places. The prior is a wide kernel in the middle for numbers, and a count of
    /// one for each choice.
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
        // A kernel is as wide as the distance to the farther neighbor.
        let width = |((before, after), place): ((f64, f64), &f64)| (place - before).max(after - place);
        Self::Kernels(widths.map(|own| (*own.1, width(own).clamp(least, 1.0))).collect())
    }

    fn draw<R: Rng>(&self, generator: &mut R) -> f64 {
        match self {
            Self::Kernels(kernels) => {
                let mut draw = || {
                    let number = generator.random_range(0..kernels.len());
                    let standard: f64 = StandardNormal.sample(generator);
                    let (center, width) = kernels[number];
                    center + width * standard
                };
                let drawn = std::iter::repeat_with(&mut draw).take(MOST_DRAWS);
                drawn.into_iter().find(|place| (0.0..1.0).contains(place)).unwrap_or(MIDDLE)
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

    /// Returns the smallest cost that a search finds in a number of trials, run in batches.
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
