//! Method 8: differential evolution.

use super::line::{Line, pair};
use super::problem::SmoothFunction;
use super::vectors::length;
use super::{ClassicalFit, ClassicalRoute, Reached};
use crate::double_double::DoubleDouble;
use crate::error::OracleError;
use envelope::Envelope;
use rand::{Rng, RngExt};
use seed::Seed;

/// Differential evolution on the sum of squares.
pub const ROUTE: ClassicalRoute = ClassicalRoute {
    id: "differential-evolution",
    paper_number: 8,
    title: "Differential evolution",
    summary: "A population of lines evolves by differences of its members (rand/1/bin), without polishing.",
    citations: &["Storn, Price, J. Global Optimization 11 (1997) 341"],
    draws: true,
    fit,
};

/// Parameters of an evolution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evolution {
    /// Number of members, at least 4.
    pub population: usize,
    /// Factor F of the difference that is added, in 0..2.
    pub difference: f64,
    /// Probability CR that a parameter comes from the mutant, in 0..1.
    pub crossover: f64,
    /// Largest number of generations.
    pub max_generations: u64,
    /// Spread at which the population has contracted: that of every parameter, relative to its range.
    pub spread: f64,
}

/// Thirty members for the line's two parameters: 15 per parameter, as in scipy.
const LINE: Evolution =
    Evolution { population: 30, difference: 0.6, crossover: 0.9, max_generations: 2000, spread: 1e-13 };

/// |cos| of the angle between residuals and columns below which the best member counts as the minimum.
const TOLERANCE: f64 = 1e-9;

/// Final state of a population.
#[derive(Debug, Clone, PartialEq)]
pub struct Evolved<V> {
    /// Parameters of the best member.
    pub best: Vec<f64>,
    /// Objective at the best member.
    pub value: V,
    /// Number of generations.
    pub generations: u64,
    /// Largest final spread of a parameter, relative to its range.
    pub spread: f64,
}

fn fit(envelope: &Envelope, seed: &Seed) -> Result<ClassicalFit, OracleError> {
    let line = Line::new(envelope);
    let moments = Moments::new(&line);
    let mut generator = seed.child("differential evolution").generator();
    let edge = widest_slope(&line);
    let evolved = minimize(|at| moments.sum_of_squares(at), &[[-edge, edge]; 2], LINE, &mut generator);
    let (_, gradient) = line.value_and_gradient(&evolved.best);
    let cosine = line.relative_gradient(&evolved.best, &gradient);
    let reached = if cosine <= TOLERANCE {
        Reached::Converged
    } else if evolved.generations >= LINE.max_generations {
        Reached::BudgetSpent
    } else {
        Reached::Stalled
    };
    let because = format!(
        "population of {} spread over {:.1e} of the box after {} generations; the residuals' largest cosine \
         with 1 and t is {cosine:.1e}, at most {TOLERANCE:.0e} wanted",
        LINE.population, evolved.spread, evolved.generations
    );
    Ok(line.fit(&evolved.best, evolved.generations, reached, because))
}

/// Returns one and a half times the steepest slope that values of standard deviation 1 can have (at perfect
/// correlation). Times start at 0, so that the constant is no larger.
fn widest_slope(line: &Line) -> f64 {
    let count = line.u.len() as f64;
    let mean = line.u.iter().sum::<f64>() / count;
    let about: Vec<f64> = line.u.iter().map(|u| u - mean).collect();
    1.5 * count.sqrt() / length(&about)
}

/// Minimizes an objective over a box by DE/rand/1/bin. It ends when the population has contracted or the
/// generations are spent. Parameters of a trial that lie outside the box are drawn anew.
///
/// The objective's values only have to be comparable. The minimum is flat, so that in double precision the
/// parameters would end with half of a double's digits; values of higher precision avoid that.
pub fn minimize<V: PartialOrd + Copy>(
    objective: impl Fn(&[f64]) -> V,
    bounds: &[[f64; 2]],
    evolution: Evolution,
    generator: &mut impl Rng,
) -> Evolved<V> {
    let size = evolution.population.max(4);
    let mut members: Vec<(Vec<f64>, V)> = (0..size)
        .map(|_| {
            let member: Vec<f64> = bounds.iter().map(|range| inside(range, generator)).collect();
            let value = objective(&member);
            (member, value)
        })
        .collect();
    let mut generations = 0;
    let mut spread = contracted(&members, bounds);
    while spread > evolution.spread && generations < evolution.max_generations {
        for target in 0..size {
            let trial = mutate(&members, target, bounds, evolution, generator);
            let value = objective(&trial);
            if let Some(member) = members.get_mut(target).filter(|(_, old)| value <= *old) {
                *member = (trial, value);
            }
        }
        generations += 1;
        spread = contracted(&members, bounds);
    }
    let better = |one: (Vec<f64>, V), other: (Vec<f64>, V)| if other.1 < one.1 { other } else { one };
    let (best, value) = members.into_iter().reduce(better).unwrap_or_else(|| (Vec::new(), objective(&[])));
    Evolved { best, value, generations, spread }
}

fn inside([low, high]: &[f64; 2], generator: &mut impl Rng) -> f64 {
    low + (high - low) * generator.random::<f64>()
}

/// Returns x₁ + F·(x₂ − x₃) of three different members, crossed with the target.
fn mutate<V>(
    members: &[(Vec<f64>, V)],
    target: usize,
    bounds: &[[f64; 2]],
    evolution: Evolution,
    generator: &mut impl Rng,
) -> Vec<f64> {
    let mut taken = vec![target];
    while taken.len() < 4 {
        let drawn = generator.random_range(0..members.len());
        if !taken.contains(&drawn) {
            taken.push(drawn);
        }
    }
    let parent =
        |at: usize| taken.get(at).and_then(|member| members.get(*member)).map(|member| member.0.iter());
    let (Some(own), Some(base), Some(plus), Some(minus)) = (parent(0), parent(1), parent(2), parent(3))
    else {
        return Vec::new();
    };
    // At least one parameter comes from the mutant.
    let certain = generator.random_range(0..bounds.len().max(1));
    own.zip(base)
        .zip(plus.zip(minus))
        .zip(bounds)
        .enumerate()
        .map(|(at, (((own, base), (plus, minus)), range))| {
            if at != certain && generator.random::<f64>() >= evolution.crossover {
                return *own;
            }
            let mutant = evolution.difference.mul_add(plus - minus, *base);
            if (range[0]..=range[1]).contains(&mutant) { mutant } else { inside(range, generator) }
        })
        .collect()
}

/// Returns the largest spread of a parameter, relative to its range.
fn contracted<V>(members: &[(Vec<f64>, V)], bounds: &[[f64; 2]]) -> f64 {
    bounds
        .iter()
        .enumerate()
        .map(|(at, [low, high])| {
            let values = || members.iter().filter_map(|member| member.0.get(at).copied());
            let widest = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
            if high > low { widest / (high - low) } else { 0.0 }
        })
        .fold(0.0, f64::max)
}

/// Moments for the sum of squares of a line, in double-double numbers. Cancellation between them costs at
/// most half of their 31 digits, and the cost of an evaluation does not grow with the number of peaks.
struct Moments {
    count: DoubleDouble,
    u: DoubleDouble,
    v: DoubleDouble,
    uu: DoubleDouble,
    uv: DoubleDouble,
    vv: DoubleDouble,
}

impl Moments {
    fn new(line: &Line) -> Self {
        let exact = |values: &[f64]| values.iter().map(|&x| DoubleDouble::from(x)).collect::<Vec<_>>();
        let (u, v) = (exact(&line.u), exact(&line.v));
        let sum = |values: &[DoubleDouble]| values.iter().copied().sum::<DoubleDouble>();
        let product = crate::double_double::dot;
        Self {
            count: DoubleDouble::from(line.u.len() as f64),
            u: sum(&u),
            v: sum(&v),
            uu: product(&u, &u),
            uv: product(&u, &v),
            vv: product(&v, &v),
        }
    }

    /// Returns Σ(a + s·u − v)² = n·a² + 2as·Σu + s²·Σu² − 2a·Σv − 2s·Σuv + Σv².
    fn sum_of_squares(&self, parameters: &[f64]) -> DoubleDouble {
        let (slope, constant) = pair(parameters);
        let (s, a) = (DoubleDouble::from(slope), DoubleDouble::from(constant));
        let (twice_s, twice_a) = (s + s, a + a);
        a * a * self.count + twice_a * s * self.u + s * s * self.uu - twice_a * self.v - twice_s * self.uv
            + self.vv
    }
}

#[cfg(test)]
mod tests {
    use super::{Evolution, Evolved, LINE, Moments, contracted, inside, minimize, mutate, widest_slope};
    use crate::classical::line::Line;
    use crate::classical::problem::SmoothFunction;
    use envelope::Envelope;
    use seed::Seed;

    /// Rastrigin's function: 11² local minima in this box, with the global minimum 0 at the origin.
    fn rastrigin(x: &[f64]) -> f64 {
        x.iter().map(|x| x * x + 10.0 - 10.0 * (std::f64::consts::TAU * x).cos()).sum()
    }

    fn evolve(seed: u64, evolution: Evolution) -> Evolved<f64> {
        minimize(rastrigin, &[[-5.12, 5.12]; 2], evolution, &mut Seed::new(seed).generator())
    }

    #[test]
    fn the_least_of_many_minima_is_found() {
        for seed in 0..5 {
            let evolved = evolve(seed, Evolution { spread: 1e-9, ..LINE });
            assert!(evolved.best.iter().all(|x| x.abs() < 1e-7), "{evolved:?}");
        }
    }

    #[test]
    fn a_seed_means_what_it_says() {
        let short = Evolution { max_generations: 20, ..LINE };
        assert_eq!(evolve(1, short), evolve(1, short));
        assert_ne!(evolve(1, short), evolve(2, short));
        assert_eq!(evolve(1, short).generations, 20);
    }

    #[test]
    fn the_moments_give_the_sum_of_squares() {
        let times: Vec<f64> = (0..20).map(|i| f64::from(i) * 0.3).collect();
        let logs = times.iter().map(|t| 1.0 - 0.2 * t + 0.3 * (5.0 * t).sin()).collect();
        let line = Line::new(&Envelope::new(times, logs, 20.0).unwrap());
        let (at, moments) = ([0.7, -0.4], Moments::new(&line));
        let direct = line.value_and_gradient(&at).0;
        assert!((moments.sum_of_squares(&at).value() / direct - 1.0).abs() < 1e-14);
    }

    fn members() -> Vec<(Vec<f64>, f64)> {
        [[0.0, 0.0], [1.0, 10.0], [3.0, 20.0], [7.0, 60.0], [15.0, -40.0]].map(|x| (x.to_vec(), 0.0)).to_vec()
    }

    const WIDE: [[f64; 2]; 2] = [[-100.0, 100.0], [-1000.0, 1000.0]];

    /// A mutant is x₁ + F·(x₂ − x₃) of three different members, none of them the target.
    #[test]
    fn a_mutant_is_one_member_and_the_difference_of_two_others() {
        let (members, mut generator) = (members(), Seed::new(5).generator());
        let evolution = Evolution { crossover: 1.0, ..LINE };
        let mut seen = std::collections::BTreeSet::new();
        for _ in 0..400 {
            let trial = mutate(&members, 2, &WIDE, evolution, &mut generator);
            let others = [0, 1, 3, 4];
            let made =
                others.iter().flat_map(|a| others.iter().flat_map(move |b| others.map(|c| (*a, *b, c))));
            let from = made.filter(|(a, b, c)| a != b && b != c && a != c).find(|(a, b, c)| {
                (0..2).all(|at| {
                    let x = |number: usize| members[number].0[at];
                    (trial[at] - (x(*a) + 0.6 * (x(*b) - x(*c)))).abs() < 1e-12
                })
            });
            seen.insert(from.unwrap_or_else(|| panic!("{trial:?}")));
        }
        assert_eq!(seen.len(), 24);
    }

    #[test]
    fn without_crossover_one_parameter_is_another() {
        let (members, mut generator) = (members(), Seed::new(6).generator());
        let evolution = Evolution { crossover: 0.0, ..LINE };
        let mut changed = [0, 0];
        for _ in 0..400 {
            let trial = mutate(&members, 4, &WIDE, evolution, &mut generator);
            let other: Vec<usize> = (0..2).filter(|at| trial[*at] != members[4].0[*at]).collect();
            assert_eq!(other.len(), 1, "{trial:?}");
            changed[other[0]] += 1;
        }
        // Both change equally often, to four standard deviations.
        assert!(changed.iter().all(|count: &i32| (count - 200).abs() < 40), "{changed:?}");
    }

    /// A parameter beyond its range is drawn anew, uniformly over the range.
    #[test]
    fn trials_stay_in_the_box() {
        let (members, mut generator) = (members(), Seed::new(7).generator());
        let narrow = [[2.0, 4.0], [-1e3, 1e3]];
        let evolution = Evolution { crossover: 1.0, difference: 1e6, ..LINE };
        let trials: Vec<f64> =
            (0..4000).map(|_| mutate(&members, 0, &narrow, evolution, &mut generator)[0]).collect();
        assert!(trials.iter().all(|x| (2.0..=4.0).contains(x)));
        let mean = trials.iter().sum::<f64>() / 4000.0;
        // The standard deviation of a uniform number over 2 is 2/√12.
        assert!((mean - 3.0).abs() < 4.0 * 2.0 / 12_f64.sqrt() / 4000_f64.sqrt(), "{mean}");
        let quarter = trials.iter().filter(|x| **x < 2.5).count();
        assert!((850..1150).contains(&quarter), "{quarter}");
    }

    #[test]
    fn the_spread_is_the_widest_over_its_range() {
        assert_eq!(contracted(&members(), &WIDE), 15.0 / 200.0);
        assert_eq!(contracted(&members(), &[[0.0, 1e3], [-50.0, 150.0]]), 0.5);
        // A parameter with a range of a single value is ignored.
        assert_eq!(contracted(&members(), &[[3.0, 3.0], [-1e3, 1e3]]), 0.05);
        assert_eq!(contracted::<f64>(&[], &[]), 0.0);
    }

    #[test]
    fn the_best_member_is_given_and_none_gets_worse() {
        let mut before = f64::INFINITY;
        for max_generations in [0, 1, 5, 25] {
            let evolved = evolve(3, Evolution { max_generations, ..LINE });
            assert_eq!((evolved.generations, evolved.value), (max_generations, rastrigin(&evolved.best)));
            assert!(evolved.value <= before, "{evolved:?}");
            before = evolved.value;
        }
        // None of the first members, drawn in this order, is better.
        let mut generator = Seed::new(3).generator();
        let first =
            (0..30).map(|_| [inside(&[-5.12, 5.12], &mut generator), inside(&[-5.12, 5.12], &mut generator)]);
        let best = first.map(|x| rastrigin(&x)).fold(f64::INFINITY, f64::min);
        assert_eq!(evolve(3, Evolution { max_generations: 0, ..LINE }).value, best);
    }

    /// Values of standard deviation 1 on times from 0 to 1 rise at most like √n/‖u − ū‖.
    #[test]
    fn the_box_holds_every_line() {
        let times: Vec<f64> = (0..9).map(f64::from).collect();
        let line = Line::new(&Envelope::new(times.clone(), times, 20.0).unwrap());
        // A straight line has the steepest possible slope: u/σ with σ² = (n² − 1)/(12·(n − 1)²).
        let steepest = (12.0 * 64.0 / 80.0_f64).sqrt();
        assert!((widest_slope(&line) / (1.5 * steepest) - 1.0).abs() < 1e-14);
    }
}
