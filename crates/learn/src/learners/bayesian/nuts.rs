//! No-U-turn sampler with multinomial weights, for a target near a standard normal distribution.
//!
//! Hoffman, Gelman, Journal of Machine Learning Research 15 (2014) 1593 (algorithm 6, dual averaging);
//! Betancourt, arXiv:1701.02434 (multinomial sampling along the trajectory).

use nalgebra::DVector;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

/// Log density with its gradient; `None` where it is undefined.
pub(super) type Target<'a> = dyn Fn(&DVector<f64>) -> Option<(f64, DVector<f64>)> + 'a;

/// Point in phase space.
#[derive(Clone)]
struct Point {
    place: DVector<f64>,
    momentum: DVector<f64>,
    log_density: f64,
    gradient: DVector<f64>,
}

impl Point {
    fn energy(&self) -> f64 {
        0.5 * self.momentum.norm_squared() - self.log_density
    }

    fn leap(&self, step: f64, target: &Target<'_>) -> Option<Self> {
        let half = &self.momentum + &self.gradient * (0.5 * step);
        let place = &self.place + &half * step;
        let (log_density, gradient) = target(&place)?;
        let momentum = half + &gradient * (0.5 * step);
        Some(Self { place, momentum, log_density, gradient })
    }
}

/// Stretch of a trajectory: its ends, a draw from it, and its weight.
struct Tree {
    back: Point,
    ahead: Point,
    draw: Point,
    log_weight: f64,
    goes_on: bool,
    acceptance: f64,
    leaps: usize,
}

/// Energy error beyond which a trajectory counts as divergent.
const LOST: f64 = 1000.0;

/// Largest number of doublings of a trajectory.
const MOST_DOUBLINGS: u32 = 5;

fn goes_on(back: &Point, ahead: &Point) -> bool {
    let between = &ahead.place - &back.place;
    between.dot(&back.momentum) >= 0.0 && between.dot(&ahead.momentum) >= 0.0
}

fn log_sum(a: f64, b: f64) -> f64 {
    let most = a.max(b);
    if most == f64::NEG_INFINITY { most } else { most + ((a - most).exp() + (b - most).exp()).ln() }
}

struct Growing<'a, R> {
    target: &'a Target<'a>,
    step: f64,
    energy: f64,
    generator: &'a mut R,
}

impl<R: Rng> Growing<'_, R> {
    /// Builds a stretch of 2^depth leapfrog steps from a point, forward or backward; `None` if the very first
    /// step fails.
    fn tree(&mut self, from: &Point, forward: bool, depth: u32) -> Option<Tree> {
        if depth == 0 {
            let point = from.leap(if forward { self.step } else { -self.step }, self.target)?;
            let gain = self.energy - point.energy();
            return Some(Tree {
                back: point.clone(),
                ahead: point.clone(),
                draw: point,
                log_weight: gain,
                goes_on: gain > -LOST,
                acceptance: gain.exp().min(1.0),
                leaps: 1,
            });
        }
        let mut tree = self.tree(from, forward, depth - 1)?;
        if !tree.goes_on {
            return Some(tree);
        }
        let end = if forward { tree.ahead.clone() } else { tree.back.clone() };
        match self.tree(&end, forward, depth - 1) {
            Some(other) => self.join(&mut tree, other, forward, false),
            None => tree.goes_on = false,
        }
        Some(tree)
    }

    /// Joins a stretch to one end of a tree. If the tree is the whole trajectory, the draw of the new stretch
    /// is preferred (biased progressive sampling).
    fn join(&mut self, tree: &mut Tree, other: Tree, forward: bool, whole: bool) {
        tree.acceptance += other.acceptance;
        tree.leaps += other.leaps;
        let all = log_sum(tree.log_weight, other.log_weight);
        let against = if whole { tree.log_weight } else { all };
        if other.goes_on && self.generator.random::<f64>().ln() < other.log_weight - against {
            tree.draw = other.draw;
        }
        tree.log_weight = all;
        if forward {
            tree.ahead = other.ahead;
        } else {
            tree.back = other.back;
        }
        tree.goes_on = other.goes_on && goes_on(&tree.back, &tree.ahead);
    }
}

/// Returns draws after a warm-up that adapts the step size; `None` if the target is undefined at zero.
pub(super) fn sample<R: Rng>(
    target: &Target<'_>,
    dimensions: usize,
    (warm_up, draws): (usize, usize),
    generator: &mut R,
) -> Option<Vec<DVector<f64>>> {
    let place = DVector::zeros(dimensions);
    let (log_density, gradient) = target(&place)?;
    let mut now = Point { momentum: DVector::zeros(dimensions), place, log_density, gradient };
    let mut step = Averaging::new(0.8);
    let mut kept = Vec::with_capacity(draws);
    for number in 0..warm_up + draws {
        for entry in now.momentum.iter_mut() {
            *entry = StandardNormal.sample(generator);
        }
        let size = if number < warm_up { step.current() } else { step.averaged() };
        let mut growing = Growing { target, step: size, energy: now.energy(), generator };
        let mut tree = Tree {
            back: now.clone(),
            ahead: now.clone(),
            draw: now.clone(),
            log_weight: 0.0,
            goes_on: true,
            acceptance: 0.0,
            leaps: 0,
        };
        for depth in 0..MOST_DOUBLINGS {
            let forward = growing.generator.random::<bool>();
            let end = if forward { tree.ahead.clone() } else { tree.back.clone() };
            match growing.tree(&end, forward, depth) {
                Some(other) => growing.join(&mut tree, other, forward, true),
                None => {
                    tree.leaps += 1;
                    tree.goes_on = false;
                }
            }
            if !tree.goes_on {
                break;
            }
        }
        if number < warm_up {
            step.learn(tree.acceptance / tree.leaps.max(1) as f64);
        }
        now = tree.draw;
        if number >= warm_up {
            kept.push(now.place.clone());
        }
    }
    Some(kept)
}

/// Dual averaging of the step size toward a wanted acceptance rate.
struct Averaging {
    wanted: f64,
    count: f64,
    missed: f64,
    log_step: f64,
    log_average: f64,
}

/// Initial step size, to which averaging shrinks: suitable for a standard normal target of a few dimensions.
const FIRST: f64 = 0.9;

impl Averaging {
    fn new(wanted: f64) -> Self {
        Self { wanted, count: 0.0, missed: 0.0, log_step: FIRST.ln(), log_average: FIRST.ln() }
    }

    fn current(&self) -> f64 {
        self.log_step.exp()
    }

    fn averaged(&self) -> f64 {
        self.log_average.exp()
    }

    fn learn(&mut self, acceptance: f64) {
        const SHRINKAGE: f64 = 0.05;
        const DELAY: f64 = 10.0;
        const FORGETTING: f64 = 0.75;
        self.count += 1.0;
        let share = 1.0 / (self.count + DELAY);
        self.missed = (1.0 - share) * self.missed + share * (self.wanted - acceptance);
        self.log_step = FIRST.ln() - self.count.sqrt() / SHRINKAGE * self.missed;
        let weight = self.count.powf(-FORGETTING);
        self.log_average = weight * self.log_step + (1.0 - weight) * self.log_average;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use seed::Seed;

    #[test]
    fn a_normal_target_is_sampled_with_its_moments() {
        let widths = [1.0, 0.7, 1.4];
        let target = |place: &DVector<f64>| {
            let scaled: Vec<f64> = place.iter().zip(widths).map(|(x, width)| x / (width * width)).collect();
            let gradient = -DVector::from_vec(scaled);
            Some((0.5 * gradient.dot(place), gradient))
        };
        let mut generator = Seed::new(5).generator();
        let draws = sample(&target, 3, (200, 4000), &mut generator).unwrap();
        for (place, width) in widths.iter().enumerate() {
            let values: Vec<f64> = draws.iter().map(|draw| draw[place]).collect();
            let mean = values.iter().sum::<f64>() / 4000.0;
            let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 4000.0;
            assert!(mean.abs() < 0.1 * width, "{mean}");
            assert!((variance.sqrt() / width - 1.0).abs() < 0.06, "{}", variance.sqrt());
        }
    }

    #[test]
    fn a_target_without_a_start_gives_no_draw() {
        assert!(sample(&|_| None, 2, (1, 1), &mut Seed::new(0).generator()).is_none());
    }
}
