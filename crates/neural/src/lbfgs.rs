//! Smooth minimization by the limited-memory BFGS method.
//!
//! Near the optimum, the loss is flat to rounding over half the digits of the parameters. There the line
//! search judges steps by the slope (approximate Wolfe conditions), and curvature pairs are accepted by a
//! relative test, so that pairs are still accepted as the steps shrink.
//!
//! Reference: Nocedal, Mathematics of Computation 35 (1980) 773; Hager, Zhang, SIAM J. Optim. 16 (2005) 170,
//! section 4.

use least_squares::{Iteration, Minimum, StopReason};
use nalgebra::DVector;
use serde::Deserialize;
use settings::{Default, Field, Kind};
use std::collections::VecDeque;
use std::ops::ControlFlow;

/// Smooth function to be minimized.
pub trait Smooth {
    /// Error of an evaluation.
    type Error;

    /// Returns value and gradient at a point.
    ///
    /// # Errors
    /// The reason why the function cannot be evaluated.
    fn value_and_gradient(&self, parameters: &DVector<f64>) -> Result<(f64, DVector<f64>), Self::Error>;
}

/// Settings of the method.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Lbfgs {
    /// Largest number of steps.
    pub max_steps: u64,
    /// Number of stored curvature pairs; 5 to 30 is usual.
    pub memory: usize,
    /// Gradient norm at which the method has converged, relative to the initial norm. 0 continues until
    /// rounding errors dominate.
    pub gradient_tolerance: f64,
}

impl Lbfgs {
    /// Key of the largest number of steps.
    pub const MAX_STEPS: Field =
        Field::new("max_steps", Kind::Integer { min: 0, max: 1_000_000 }, Default::Integer(200))
            .meaning("Most L-BFGS steps.")
            .source("several times what ten seeds take on the shipped record");
    /// Key of the number of stored curvature pairs.
    pub const MEMORY: Field = Field::new("memory", Kind::Integer { min: 1, max: 100 }, Default::Integer(10))
        .meaning("Curvature pairs that L-BFGS remembers.")
        .source("Nocedal, Wright, Numerical Optimization (2006), section 7.2: 3 to 20");
    /// Key of the gradient norm at which the method has converged.
    pub const GRADIENT_TOLERANCE: Field =
        Field::new("gradient_tolerance", Kind::Float { min: 0.0, max: 0.1 }, Default::Float(1e-13))
            .meaning(
                "Training has converged when the gradient has fallen to this share of its length at \
                    the start.",
            )
            .source("a few roundings above what double precision leaves");
}

/// Relative change of the loss that counts as rounding.
const ROUNDING_SHARE: f64 = 1e-12;
/// Sufficient decrease (Armijo).
const DECREASE: f64 = 1e-4;
/// Sufficient flattening (Wolfe).
const FLATTENING: f64 = 0.9;
/// Largest number of evaluations in one line search.
const MOST_EVALUATIONS: u32 = 40;
/// Smallest cosine between a step and its change of gradient for an accepted curvature pair.
const SMALLEST_COSINE: f64 = 1e-10;

struct Point {
    parameters: DVector<f64>,
    loss: f64,
    gradient: DVector<f64>,
}

impl Point {
    fn new<P: Smooth>(problem: &P, parameters: DVector<f64>) -> Result<Self, P::Error> {
        let (loss, gradient) = problem.value_and_gradient(&parameters)?;
        Ok(Self { parameters, loss, gradient })
    }

    fn is_finite(&self) -> bool {
        self.loss.is_finite() && self.gradient.iter().all(|entry| entry.is_finite())
    }
}

/// Curvature pair: a step, and the change of the gradient along it.
struct Pair {
    step: DVector<f64>,
    change: DVector<f64>,
    curvature: f64,
}

impl Lbfgs {
    /// Minimizes a function from a starting point. `observe` gets the start and the state after every step,
    /// and may stop the method.
    ///
    /// # Errors
    /// The error of the function's evaluation.
    pub fn minimize<P: Smooth>(
        &self,
        problem: &P,
        start: DVector<f64>,
        mut observe: impl FnMut(Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<Minimum, P::Error> {
        let mut point = Point::new(problem, start)?;
        let first_length = point.gradient.norm();
        let mut pairs: VecDeque<Pair> = VecDeque::new();
        let mut steps = 0;
        let mut last_gain = f64::INFINITY;
        let reason = loop {
            let state = Iteration { step: steps, parameters: &point.parameters, loss: point.loss };
            if observe(state).is_break() {
                break StopReason::Interrupted;
            }
            if !point.is_finite() {
                break StopReason::NotFinite;
            }
            if point.gradient.norm() <= self.gradient_tolerance * first_length {
                break StopReason::Settled;
            }
            if steps >= self.max_steps {
                break StopReason::StepsSpent;
            }
            let mut next = descend(problem, &point, &pairs)?;
            if next.is_none() && !pairs.is_empty() {
                // Rounding errors have spoiled the pairs: restart along the steepest descent.
                pairs.clear();
                next = descend(problem, &point, &pairs)?;
            }
            let Some(next) = next else {
                break StopReason::Stationary;
            };
            steps += 1;
            last_gain = (point.loss - next.loss) / point.loss.abs();
            remember(&mut pairs, self.memory, &point, &next);
            point = next;
        };
        Ok(Minimum { parameters: point.parameters, loss: point.loss, last_gain, steps, reason })
    }
}

/// Returns the next point along the quasi-Newton direction; `None` if the loss cannot be lowered along it.
fn descend<P: Smooth>(problem: &P, point: &Point, pairs: &VecDeque<Pair>) -> Result<Option<Point>, P::Error> {
    let direction = -inverse_hessian_times(pairs, &point.gradient);
    if direction.dot(&point.gradient) >= 0.0 {
        return Ok(None);
    }
    // Without a curvature pair, the gradient has no scale.
    let length = if pairs.is_empty() { (1.0 / point.gradient.norm()).min(1.0) } else { 1.0 };
    line_search(problem, point, &direction, length)
}

/// Multiplies a vector by the approximate inverse Hessian, by the two-loop recursion.
fn inverse_hessian_times(pairs: &VecDeque<Pair>, vector: &DVector<f64>) -> DVector<f64> {
    let mut result = vector.clone();
    let mut shares = Vec::with_capacity(pairs.len());
    for pair in pairs.iter().rev() {
        let share = pair.step.dot(&result) / pair.curvature;
        result.axpy(-share, &pair.change, 1.0);
        shares.push(share);
    }
    if let Some(last) = pairs.back() {
        result *= last.curvature / last.change.norm_squared();
    }
    for (pair, share) in pairs.iter().zip(shares.into_iter().rev()) {
        let back = pair.change.dot(&result) / pair.curvature;
        result.axpy(share - back, &pair.step, 1.0);
    }
    result
}

fn remember(pairs: &mut VecDeque<Pair>, memory: usize, from: &Point, to: &Point) {
    let step = &to.parameters - &from.parameters;
    let change = &to.gradient - &from.gradient;
    let curvature = step.dot(&change);
    if curvature > SMALLEST_COSINE * step.norm() * change.norm() {
        if pairs.len() >= memory.max(1) {
            pairs.pop_front();
        }
        pairs.push_back(Pair { step, change, curvature });
    }
}

/// Searches along a direction for a point that lowers the loss enough or, if rounding hides the loss,
/// flattens the slope enough; `None` if none is found.
///
/// The lower end of the bracket slopes down and is no higher than the start; its upper end slopes up or is
/// higher. Secant steps on the slope, or bisections if these leave the bracket, close in on the minimum.
fn line_search<P: Smooth>(
    problem: &P,
    start: &Point,
    direction: &DVector<f64>,
    first_length: f64,
) -> Result<Option<Point>, P::Error> {
    let start_slope = start.gradient.dot(direction);
    let ceiling = start.loss + ROUNDING_SHARE * start.loss.abs();
    let (mut low, mut low_slope) = (0.0, start_slope);
    let mut high: Option<(f64, f64)> = None;
    let mut length = first_length;
    for _ in 0..MOST_EVALUATIONS {
        let point = Point::new(problem, &start.parameters + direction * length)?;
        let slope = point.gradient.dot(direction);
        let finite = point.is_finite();
        let flat = slope >= FLATTENING * start_slope;
        let armijo = point.loss <= start.loss + DECREASE * length * start_slope;
        let nearly = point.loss <= ceiling && slope <= (2.0 * DECREASE - 1.0) * start_slope;
        if finite && flat && (armijo && slope.abs() <= FLATTENING * start_slope.abs() || nearly) {
            return Ok(Some(point));
        }
        if finite && slope < 0.0 && point.loss <= ceiling {
            (low, low_slope) = (length, slope);
        } else {
            high = Some((length, if finite { slope } else { f64::NAN }));
        }
        length = match high {
            None => length * 4.0,
            Some((high, high_slope)) => {
                let secant = (low * high_slope - high * low_slope) / (high_slope - low_slope);
                let inner = low + 0.1 * (high - low)..low + 0.9 * (high - low);
                if inner.contains(&secant) { secant } else { f64::midpoint(low, high) }
            }
        };
        let (from, to) = (low, high.map_or(f64::INFINITY, |(high, _)| high));
        if to - from <= f64::EPSILON * from || length == from {
            break;
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::{Lbfgs, Smooth};
    use least_squares::StopReason;
    use nalgebra::DVector;
    use std::convert::Infallible;
    use std::ops::ControlFlow;

    /// Rosenbrock's function in pairs (Computer Journal 3 (1960) 175), raised by 1 so that rounding hides
    /// small changes near its minimum.
    struct Rosenbrock;

    impl Smooth for Rosenbrock {
        type Error = Infallible;

        fn value_and_gradient(&self, x: &DVector<f64>) -> Result<(f64, DVector<f64>), Infallible> {
            let mut value = 1.0;
            let mut gradient = DVector::zeros(x.len());
            for at in (0..x.len()).step_by(2) {
                let (bend, rest) = (x[at + 1] - x[at] * x[at], 1.0 - x[at]);
                value += 100.0 * bend * bend + rest * rest;
                gradient[at] = -400.0 * x[at] * bend - 2.0 * rest;
                gradient[at + 1] = 200.0 * bend;
            }
            Ok((value, gradient))
        }
    }

    const METHOD: Lbfgs = Lbfgs { max_steps: 1000, memory: 10, gradient_tolerance: 0.0 };

    #[test]
    fn it_reaches_the_minimum_beyond_the_roundings_of_the_loss() {
        let start = DVector::from_fn(20, |at, _| if at % 2 == 0 { -1.2 } else { 1.0 });
        let minimum = METHOD.minimize(&Rosenbrock, start, |_| ControlFlow::Continue(())).unwrap();
        let off = minimum.parameters.iter().map(|x| (x - 1.0).abs()).fold(0.0, f64::max);
        assert!(off < 1e-12, "{off:e} {:?} after {} steps", minimum.reason, minimum.steps);
        assert!(minimum.steps < 100, "{}", minimum.steps);
    }

    #[test]
    fn it_settles_stops_and_is_spent() {
        let start = || DVector::from_vec(vec![-1.2, 1.0]);
        let go =
            |method: Lbfgs| method.minimize(&Rosenbrock, start(), |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(go(Lbfgs { gradient_tolerance: 1e-6, ..METHOD }).reason, StopReason::Settled);
        let spent = go(Lbfgs { max_steps: 3, ..METHOD });
        assert_eq!((spent.reason, spent.steps), (StopReason::StepsSpent, 3));
        let stopped = METHOD
            .minimize(&Rosenbrock, start(), |state| {
                if state.step == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
            .unwrap();
        assert_eq!((stopped.reason, stopped.steps), (StopReason::Interrupted, 2));
    }

    #[test]
    fn every_step_is_told_once() {
        let start = DVector::from_fn(20, |at, _| if at % 2 == 0 { -1.2 } else { 1.0 });
        let mut told = Vec::new();
        let minimum = METHOD.minimize(&Rosenbrock, start, |state| {
            told.push(state.step);
            ControlFlow::Continue(())
        });
        assert_eq!(told, (0..=minimum.unwrap().steps).collect::<Vec<_>>());
    }

    #[test]
    fn a_loss_that_is_not_finite_is_said() {
        struct Pole;
        impl Smooth for Pole {
            type Error = Infallible;
            fn value_and_gradient(&self, x: &DVector<f64>) -> Result<(f64, DVector<f64>), Infallible> {
                Ok((x[0].ln(), DVector::from_vec(vec![1.0 / x[0]])))
            }
        }
        let go = |start: f64| {
            METHOD.minimize(&Pole, DVector::from_vec(vec![start]), |_| ControlFlow::Continue(())).unwrap()
        };
        assert_eq!(go(-1.0).reason, StopReason::NotFinite);
        assert!(go(1.0).parameters[0].is_finite());
    }
}
