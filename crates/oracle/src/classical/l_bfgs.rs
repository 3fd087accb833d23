//! Method 7: limited-memory BFGS.

use super::line::{Line, NEUTRAL, TOLERANCE};
use super::problem::{Limits, Minimum, SmoothFunction};
use super::vectors::{add_scaled, dot, finite, length, minus};
use super::{ClassicalFit, ClassicalRoute, Reached};
use crate::error::OracleError;
use envelope::Envelope;
use seed::Seed;
use std::collections::VecDeque;

/// Limited-memory BFGS on the sum of squares.
pub const ROUTE: ClassicalRoute = ClassicalRoute {
    id: "l-bfgs",
    paper_number: 7,
    title: "L-BFGS",
    summary: "A quasi-Newton method that keeps the last ten changes of the gradient.",
    citations: &[
        "Liu, Nocedal, Mathematical Programming 45 (1989) 503",
        "Hager, Zhang, SIAM J. Optim. 16 (2005) 170: acceptance near the optimum",
    ],
    draws: false,
    fit,
};

/// Pairs kept.
const MEMORY: usize = 10;

/// Decrease that a step must bring, as a share of what the slope promises.
const LEAST_DECREASE: f64 = 1e-4;

/// Share of the slope that a step may leave.
const MOST_SLOPE: f64 = 0.9;

/// Trials of a line search.
const MOST_TRIALS: usize = 60;

fn fit(envelope: &Envelope, _: &Seed) -> Result<ClassicalFit, OracleError> {
    let line = Line::new(envelope);
    let minimum = minimize(&line, &NEUTRAL, Limits { tolerance: TOLERANCE, max_steps: 200 })?;
    Ok(line.fit(&minimum.parameters, minimum.steps, minimum.reached, minimum.because))
}

/// Minimizes a function from a start until its relative gradient is at most the tolerance.
///
/// Steps fulfil Wolfe's conditions; where the function is flat to rounding, the slope alone decides
/// (Hager and Zhang's approximate condition), so that the gradient, not the function, limits the digits.
///
/// # Errors
/// [`OracleError::NotFinite`] (row 1) where the function or its gradient is not finite at the start.
pub fn minimize(
    function: &impl SmoothFunction,
    start: &[f64],
    limits: Limits,
) -> Result<Minimum, OracleError> {
    let mut here = Point::at(function, start.to_vec()).ok_or(OracleError::NotFinite { row: 1 })?;
    let mut pairs: VecDeque<Pair> = VecDeque::new();
    let mut steps = 0;
    loop {
        let relative_gradient = function.relative_gradient(&here.x, &here.gradient);
        let found = if relative_gradient <= limits.tolerance {
            Some(Reached::Converged)
        } else if steps >= limits.max_steps {
            Some(Reached::BudgetSpent)
        } else {
            None
        };
        let next = match found {
            None => search(function, &here, &direction(&here.gradient, &pairs), pairs.is_empty()),
            Some(_) => None,
        };
        let Some(next) = next else {
            // A search that fails along an old curvature may succeed along the gradient.
            if found.is_none() && !pairs.is_empty() {
                pairs.clear();
                continue;
            }
            let reached = found.unwrap_or(Reached::Stalled);
            let because = explain(reached, relative_gradient, steps, limits);
            let Point { x: parameters, value, .. } = here;
            return Ok(Minimum { parameters, value, relative_gradient, steps, reached, because });
        };
        steps += 1;
        let pair = Pair::between(&here, &next);
        if pair.curvature > f64::EPSILON * length(&pair.step) * length(&pair.change) {
            pairs.push_back(pair);
            if pairs.len() > MEMORY {
                pairs.pop_front();
            }
        }
        here = next;
    }
}

fn explain(reached: Reached, gradient: f64, steps: u64, limits: Limits) -> String {
    let state = format!("relative gradient {gradient:.1e} after {steps} steps");
    match reached {
        Reached::Converged => format!("{state}, at most {:.0e} wanted", limits.tolerance),
        Reached::BudgetSpent => {
            format!("{state}, the budget; {:.0e} wanted. Raise the budget", limits.tolerance)
        }
        Reached::Stalled => format!("{state} and no step gains; {:.0e} wanted", limits.tolerance),
    }
}

struct Point {
    x: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
}

impl Point {
    fn at(function: &impl SmoothFunction, x: Vec<f64>) -> Option<Self> {
        let (value, gradient) = function.value_and_gradient(&x);
        (value.is_finite() && finite(&gradient)).then_some(Self { x, value, gradient })
    }
}

/// A step and the gradient's change over it.
struct Pair {
    step: Vec<f64>,
    change: Vec<f64>,
    curvature: f64,
}

impl Pair {
    fn between(here: &Point, next: &Point) -> Self {
        let (step, change) = (minus(&next.x, &here.x), minus(&next.gradient, &here.gradient));
        let curvature = dot(&step, &change);
        Self { step, change, curvature }
    }
}

/// Minus the gradient times the approximate inverse of the second derivative: the two-loop recursion.
fn direction(gradient: &[f64], pairs: &VecDeque<Pair>) -> Vec<f64> {
    let mut down: Vec<f64> = gradient.iter().map(|g| -g).collect();
    let mut shares = Vec::new();
    for pair in pairs.iter().rev() {
        let share = dot(&pair.step, &down) / pair.curvature;
        add_scaled(&mut down, -share, &pair.change);
        shares.push(share);
    }
    if let Some(last) = pairs.back() {
        let scale = last.curvature / dot(&last.change, &last.change);
        down.iter_mut().for_each(|x| *x *= scale);
    }
    for (pair, share) in pairs.iter().zip(shares.iter().rev()) {
        let back = dot(&pair.change, &down) / pair.curvature;
        add_scaled(&mut down, share - back, &pair.step);
    }
    down
}

/// Looks along a direction for a step that fulfils Wolfe's conditions; `None` where there is none.
fn search(function: &impl SmoothFunction, here: &Point, direction: &[f64], first: bool) -> Option<Point> {
    let slope = dot(&here.gradient, direction);
    if slope.is_nan() || slope >= 0.0 {
        return None;
    }
    // Without curvature the first trial moves by about one.
    let mut trial = if first { (1.0 / length(direction)).min(1.0) } else { 1.0 };
    let rounding = 1e-13 * here.value.abs();
    // A step that is too short and its slope; one that is too long, with its slope where it is finite.
    let (mut short, mut short_slope) = (0.0, slope);
    let mut long: Option<(f64, Option<f64>)> = None;
    for _ in 0..MOST_TRIALS {
        let mut x = here.x.clone();
        add_scaled(&mut x, trial, direction);
        if x == here.x {
            return None;
        }
        match Point::at(function, x) {
            None => long = Some((trial, None)),
            Some(next) => {
                let new_slope = dot(&next.gradient, direction);
                let gain = here.value - next.value;
                let enough = gain >= -LEAST_DECREASE * trial * slope;
                let flat = gain >= -rounding && new_slope <= (2.0 * LEAST_DECREASE - 1.0) * slope;
                if !(enough || flat) || new_slope > -MOST_SLOPE * slope {
                    long = Some((trial, Some(new_slope)));
                } else if new_slope < MOST_SLOPE * slope {
                    (short, short_slope) = (trial, new_slope);
                } else {
                    return Some(next);
                }
            }
        }
        trial = match long {
            None => 2.0 * trial,
            Some((long, slope)) => between(short, short_slope, long, slope),
        };
    }
    None
}

/// A trial inside a bracket: where the slope vanishes if it is linear, else the middle.
fn between(short: f64, short_slope: f64, long: f64, long_slope: Option<f64>) -> f64 {
    let width = long - short;
    let share = match long_slope {
        Some(slope) if slope > 0.0 => (short_slope / (short_slope - slope)).clamp(0.05, 0.95),
        _ => 0.5,
    };
    short + share * width
}

#[cfg(test)]
mod tests {
    use super::minimize;
    use crate::classical::problem::{Limits, SmoothFunction};
    use crate::classical::{Minimum, Reached};

    /// Rosenbrock's valley in n dimensions.
    struct Valley;

    impl SmoothFunction for Valley {
        fn value_and_gradient(&self, x: &[f64]) -> (f64, Vec<f64>) {
            let mut gradient = vec![0.0; x.len()];
            let mut value = 0.0;
            for i in 0..x.len() - 1 {
                let (bend, rest) = (x[i + 1] - x[i] * x[i], 1.0 - x[i]);
                value += 100.0 * bend * bend + rest * rest;
                gradient[i] += -400.0 * bend * x[i] - 2.0 * rest;
                gradient[i + 1] += 200.0 * bend;
            }
            (value, gradient)
        }

        fn relative_gradient(&self, _: &[f64], gradient: &[f64]) -> f64 {
            gradient.iter().fold(0.0, |largest, g| largest.max(g.abs() / 400.0))
        }
    }

    fn descend(start: &[f64], max_steps: u64) -> Minimum {
        minimize(&Valley, start, Limits { tolerance: 1e-12, max_steps }).unwrap()
    }

    #[test]
    fn the_valley_s_floor_is_found() {
        for size in [2, 10] {
            let start: Vec<f64> = (0..size).map(|i| if i % 2 == 0 { -1.2 } else { 1.0 }).collect();
            let minimum = descend(&start, 500);
            assert_eq!(minimum.reached, Reached::Converged, "{minimum:?}");
            assert!(minimum.steps < 150, "{}", minimum.steps);
            // In ten dimensions there is a second minimum near x₁ = −1.
            if size == 2 {
                assert!(minimum.parameters.iter().all(|x| (x - 1.0).abs() < 1e-10), "{minimum:?}");
            }
        }
    }

    #[test]
    fn a_short_budget_says_so() {
        let minimum = descend(&[-1.2, 1.0], 3);
        assert_eq!((minimum.reached, minimum.steps), (Reached::BudgetSpent, 3));
        assert!(minimum.because.contains("after 3 steps, the budget"), "{}", minimum.because);
    }

    #[test]
    fn a_start_without_a_value_is_refused() {
        assert!(minimize(&Valley, &[f64::NAN, 0.0], Limits { tolerance: 1e-12, max_steps: 9 }).is_err());
    }
}
