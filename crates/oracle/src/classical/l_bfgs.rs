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

/// Number of stored pairs.
const MEMORY: usize = 10;

/// Smallest decrease by a step, as a share of the decrease that the slope predicts.
const LEAST_DECREASE: f64 = 1e-4;

/// Largest slope after a step, as a share of the slope before.
const MOST_SLOPE: f64 = 0.9;

/// Most trials of a line search.
const MOST_TRIALS: usize = 60;

fn fit(envelope: &Envelope, _: &Seed) -> Result<ClassicalFit, OracleError> {
    let line = Line::new(envelope);
    let minimum = minimize(&line, &NEUTRAL, Limits { tolerance: TOLERANCE, max_steps: 200 })?;
    Ok(line.fit(&minimum.parameters, minimum.steps, minimum.reached, minimum.because))
}

/// Minimizes a function from a start until its relative gradient is at most the tolerance.
///
/// Steps satisfy Wolfe's conditions. Where the function is flat to rounding, only the slope decides (the
/// approximate condition of Hager and Zhang), so that the digits are limited by the gradient and not by the
/// function.
///
/// # Errors
/// [`OracleError::NotFinite`] (row 1) if the function or its gradient is not finite at the start.
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
            // A search that fails along a direction with old curvature may succeed along the gradient.
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

/// Step, with the change of the gradient over it.
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

/// Returns minus the gradient times the approximate inverse of the second derivative, by the two-loop
/// recursion.
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

/// Searches along a direction for a step that satisfies Wolfe's conditions; `None` if none is found.
fn search(function: &impl SmoothFunction, here: &Point, direction: &[f64], first: bool) -> Option<Point> {
    let slope = dot(&here.gradient, direction);
    if slope.is_nan() || slope >= 0.0 {
        return None;
    }
    // Without curvature the first trial moves by at most one.
    let mut trial = if first { (1.0 / length(direction)).min(1.0) } else { 1.0 };
    let rounding = 1e-13 * here.value.abs();
    // A step that is too short, with its slope; and one that is too long, with its slope if finite.
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

/// Returns a trial inside a bracket: the zero of the slope by linear interpolation, or the middle if the
/// slope at the far end is unknown or not positive.
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
    use super::{OracleError, Pair, Point, between, direction, explain, minimize, search};
    use crate::classical::problem::{Limits, SmoothFunction};
    use crate::classical::vectors::{dot, length};
    use crate::classical::{Minimum, Reached};
    use std::collections::VecDeque;

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
        let refused = minimize(&Valley, &[f64::NAN, 0.0], Limits { tolerance: 1e-12, max_steps: 9 });
        assert!(matches!(refused, Err(OracleError::NotFinite { row: 1 })), "{refused:?}");
    }

    /// Function ½·Σ i·xᵢ².
    struct Bowl;

    impl SmoothFunction for Bowl {
        fn value_and_gradient(&self, x: &[f64]) -> (f64, Vec<f64>) {
            let gradient: Vec<f64> = (1..).zip(x).map(|(i, x)| f64::from(i) * x).collect();
            (0.5 * dot(x, &gradient), gradient)
        }

        fn relative_gradient(&self, _: &[f64], gradient: &[f64]) -> f64 {
            length(gradient)
        }
    }

    fn point(function: &impl SmoothFunction, x: &[f64]) -> Point {
        Point::at(function, x.to_vec()).unwrap()
    }

    /// The approximate inverse reproduces the last change of the gradient: H·y = s. All directions descend.
    #[test]
    fn the_approximate_inverse_knows_the_last_step() {
        let path = [[3.0, -1.0, 2.0], [1.0, -0.5, 1.5], [0.7, 0.1, 0.2], [-0.2, 0.3, 0.1]];
        let points: Vec<Point> = path.iter().map(|x| point(&Bowl, x)).collect();
        let pairs: VecDeque<Pair> = points.windows(2).map(|two| Pair::between(&two[0], &two[1])).collect();
        for count in 1..=pairs.len() {
            let pairs: VecDeque<Pair> =
                (0..count).map(|at| Pair::between(&points[at], &points[at + 1])).collect();
            let last = pairs.back().unwrap();
            let back = direction(&last.change, &pairs);
            assert!(back.iter().zip(&last.step).all(|(b, s)| (b + s).abs() < 1e-12), "{back:?}");
            for gradient in [[1.0, 0.0, 0.0], [-2.0, 5.0, 0.3]] {
                assert!(dot(&direction(&gradient, &pairs), &gradient) < 0.0);
            }
        }
        // Without a pair the direction is minus the gradient.
        assert_eq!(direction(&[1.0, -2.0], &VecDeque::new()), [-1.0, 2.0]);
        assert!((pairs[0].curvature - (4.0 + 2.0 * 0.25 + 3.0 * 0.25)).abs() < 1e-14);
    }

    /// Tests Wolfe's conditions from steep and almost flat starts, with directions of any length.
    #[test]
    fn a_step_that_is_found_fulfills_wolfe_s_conditions() {
        let mut found = 0;
        for start in [[-1.2, 1.0], [2.0, -3.0], [0.9, 0.81], [0.0, 0.0]] {
            let here = point(&Valley, &start);
            for scale in [1e-6, 1e-3, 1.0, 30.0] {
                for first in [true, false] {
                    let direction: Vec<f64> = here.gradient.iter().map(|g| -scale * g).collect();
                    let Some(next) = search(&Valley, &here, &direction, first) else { continue };
                    let slope = dot(&here.gradient, &direction);
                    let moved: Vec<f64> = next.x.iter().zip(&here.x).map(|(a, b)| a - b).collect();
                    let trial = length(&moved) / length(&direction);
                    assert!(next.value <= here.value + 1.001e-4 * trial * slope);
                    assert!(dot(&next.gradient, &direction).abs() <= 0.9 * slope.abs());
                    found += 1;
                }
            }
            let up: Vec<f64> = here.gradient.clone();
            assert!(search(&Valley, &here, &up, false).is_none());
        }
        assert!(found >= 30, "{found}");
    }

    #[test]
    fn a_trial_lies_inside_its_bracket() {
        // Zero of a straight line from −2 to 2.
        assert_eq!(between(1.0, -2.0, 3.0, Some(2.0)), 2.0);
        assert_eq!(between(1.0, -1.0, 3.0, Some(3.0)), 1.5);
        // The trial keeps a distance from the ends of the bracket.
        assert!((between(0.0, -1e-9, 1.0, Some(1.0)) - 0.05).abs() < 1e-15);
        assert!((between(0.0, -1.0, 1.0, Some(1e-9)) - 0.95).abs() < 1e-15);
        for without in [None, Some(-1.0), Some(0.0)] {
            assert_eq!(between(1.0, -1.0, 4.0, without), 2.5);
        }
    }

    /// A quadratic in four parameters takes about as many steps as it has parameters, as with conjugate
    /// gradients.
    #[test]
    fn a_quadratic_takes_few_steps() {
        let minimum =
            minimize(&Bowl, &[4.0, -3.0, 2.0, 1.0], Limits { tolerance: 1e-10, max_steps: 100 }).unwrap();
        assert_eq!(minimum.reached, Reached::Converged);
        assert!(minimum.steps <= 20, "{}", minimum.steps);
        assert!(minimum.value < 1e-20 && minimum.relative_gradient <= 1e-10);
    }

    #[test]
    fn every_end_is_told() {
        for (reached, says) in [
            (Reached::Converged, "relative gradient 2.0e-3 after 7 steps, at most 1e-12 wanted"),
            (Reached::BudgetSpent, "after 7 steps, the budget; 1e-12 wanted. Raise the budget"),
            (Reached::Stalled, "after 7 steps and no step gains; 1e-12 wanted"),
        ] {
            let told = explain(reached, 2e-3, 7, Limits { tolerance: 1e-12, max_steps: 7 });
            assert!(told.contains(says), "{told}");
        }
    }
}
