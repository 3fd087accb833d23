//! Method 10: the trust-region reflective method, as in `scipy.optimize.least_squares`.

use super::line::{Line, NEUTRAL, TOLERANCE};
use super::local::Local;
use super::problem::{LeastSquaresProblem, LeastSquaresSolution, Limits};
use super::qr::factorize;
use super::reflection::{Model, Walls, select};
use super::vectors::{add_scaled, diagonal, finite, length, times};
use super::{ClassicalFit, ClassicalRoute, Reached};
use crate::error::OracleError;
use envelope::Envelope;
use seed::Seed;

/// Trust-region reflective on the line, without bounds.
pub const ROUTE: ClassicalRoute = ClassicalRoute {
    id: "trust-region",
    paper_number: 10,
    title: "Trust-region reflective (least_squares)",
    summary: "Gauss–Newton models in a trusted ball, scaled and reflected at the bounds of the parameters.",
    citations: &[
        "Branch, Coleman, Li, SIAM J. Sci. Comput. 21 (1999) 1",
        "Coleman, Li, SIAM J. Optim. 6 (1996) 418",
    ],
    draws: false,
    fit,
};

fn fit(envelope: &Envelope, _: &Seed) -> Result<ClassicalFit, OracleError> {
    let line = Line::new(envelope);
    let limits = Limits { tolerance: TOLERANCE, max_steps: 200 };
    Ok(line.fit_with_error(minimize(&line, &NEUTRAL, &Bounds::none(2), limits)?))
}

/// Lower and upper bounds of parameters; infinite for an unbounded side.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    low: Vec<f64>,
    high: Vec<f64>,
}

impl Bounds {
    /// Creates bounds of parameters, in their order.
    ///
    /// # Errors
    /// [`OracleError::Bounds`] if a lower bound is not below its upper one, or one is missing.
    pub fn new(low: Vec<f64>, high: Vec<f64>) -> Result<Self, OracleError> {
        let at = |values: &[f64], index: usize| values.get(index).copied().unwrap_or(f64::NAN);
        for index in 0..low.len().max(high.len()) {
            let (low, high) = (at(&low, index), at(&high, index));
            if low.is_nan() || high.is_nan() || low >= high {
                return Err(OracleError::Bounds { parameter: index + 1, low, high });
            }
        }
        Ok(Self { low, high })
    }

    /// Creates bounds at −∞ and ∞ for a number of parameters.
    #[must_use]
    pub fn none(parameters: usize) -> Self {
        Self { low: vec![f64::NEG_INFINITY; parameters], high: vec![f64::INFINITY; parameters] }
    }
}

/// Minimizes a sum of squares from a start within bounds. The parameters stay strictly inside.
///
/// The variables are those of Coleman and Li, scaled by the distance to the bound that the descent leads to.
/// Each step minimizes the Gauss–Newton model in a ball. A step that leaves the box is cut off, reflected or
/// replaced by the gradient's, whichever the model prefers. The variables are also scaled by the largest
/// lengths so far of the Jacobian's columns (scipy's `x_scale = "jac"`).
///
/// Converged means the same as for the Levenberg–Marquardt method, except that some parameters do not count:
/// those so near a bound in the direction of descent that reaching it would change the residuals by less than
/// the tolerance.
///
/// # Errors
/// [`OracleError::NotFinite`] if a residual is not finite at the start, [`OracleError::TooFewRows`] for fewer
/// residuals than parameters, [`OracleError::Bounds`] if the number of bounds differs from that of the
/// parameters.
pub fn minimize(
    problem: &impl LeastSquaresProblem,
    start: &[f64],
    bounds: &Bounds,
    limits: Limits,
) -> Result<LeastSquaresSolution, OracleError> {
    if bounds.low.len() != start.len() {
        let parameter = bounds.low.len().min(start.len()) + 1;
        return Err(OracleError::Bounds { parameter, low: f64::NAN, high: f64::NAN });
    }
    let walls = Walls { low: &bounds.low, high: &bounds.high };
    let mut x = walls.inside(start);
    let mut here = Local::start(problem, &x, &limits)?;
    let mut scales = here.lengths.clone();
    let mut frame = Frame::at(&here, &walls, &x, &scales, &limits);
    let first: Vec<f64> = x.iter().zip(&frame.scale).map(|(x, scale)| x / scale).collect();
    let mut radius = match length(&first) {
        size if size > 0.0 && size.is_finite() => size,
        _ => 1.0,
    };
    let mut steps = 0;
    let reached = loop {
        if here.is_stationary(frame.orthogonality, &limits) {
            break Reached::Converged;
        }
        if steps >= limits.max_steps {
            break Reached::BudgetSpent;
        }
        steps += 1;
        let (step, value) = select(&frame.model, &walls, &x, &frame.scale, radius, frame.share);
        let mut next = x.clone();
        add_scaled(&mut next, 1.0, &times(&frame.scale, &step));
        let next = walls.inside(&next);
        let size = length(&step);
        let cost = 0.5 * here.size * here.size;
        let flat = -value <= here.flat(problem) * cost;

        let residuals = problem.residuals(&next);
        let there = length(&residuals);
        let actual = if finite(&residuals) { cost - 0.5 * there * there } else { f64::NEG_INFINITY };
        let candidate = if flat || actual > 0.0 { Local::evaluate(problem, &next, &limits) } else { None };
        let candidate = candidate.map(|there| {
            let grown: Vec<f64> = scales.iter().zip(&there.lengths).map(|(a, b)| a.max(*b)).collect();
            let frame = Frame::at(&there, &walls, &next, &grown, &limits);
            (there, grown, frame)
        });
        if flat {
            // The gain is below rounding, so that the orthogonality decides.
            match candidate {
                Some(found) if found.2.orthogonality < frame.orthogonality => {
                    x = next;
                    (here, scales, frame) = found;
                    continue;
                }
                _ => break Reached::Stalled,
            }
        }
        let ratio = actual / -value;
        if ratio.is_nan() || ratio < 0.25 {
            radius = 0.25 * size;
        } else if ratio > 0.75 && size > 0.95 * radius {
            radius *= 2.0;
        }
        match candidate {
            Some(found) => {
                x = next;
                (here, scales, frame) = found;
            }
            None if actual > 0.0 => radius = radius.min(0.25 * size),
            None => {}
        }
        if radius <= f64::EPSILON * length(&times(&scales, &x)) {
            break Reached::Stalled;
        }
    };
    let orthogonality = frame.orthogonality;
    Ok(here.report(x, steps, reached, orthogonality, &limits))
}

/// Coleman and Li's variables at a point, with the model in them.
struct Frame {
    /// Lengths in x of the variables' units.
    scale: Vec<f64>,
    model: Model,
    /// Share of the distance to a wall that a step may cover.
    share: f64,
    /// Orthogonality of the residuals to the tangent space of the parameters not held at a bound.
    orthogonality: f64,
}

impl Frame {
    fn at(here: &Local, walls: &Walls, x: &[f64], scales: &[f64], limits: &Limits) -> Self {
        let gradient = here.gradient();
        // Distance to the bound that the descent leads to, in scaled units; `None` without a bound.
        let distances: Vec<Option<f64>> = x
            .iter()
            .zip(walls.low.iter().zip(walls.high))
            .zip(&gradient)
            .map(|((x, (low, high)), g)| match *g {
                g if g < 0.0 && high.is_finite() => Some(high - x),
                g if g > 0.0 && low.is_finite() => Some(x - low),
                _ => None,
            })
            .collect();
        let (mut scale, mut extra, mut pressure) = (Vec::new(), Vec::new(), 0.0_f64);
        for ((distance, unit), g) in distances.iter().zip(scales).zip(&gradient) {
            let reach = distance.map_or(1.0, |distance| distance * unit);
            scale.push(reach.sqrt() / unit);
            // Curvature from the changing distance: |g| in scaled units; none without a bound.
            extra.push(distance.map_or(0.0, |_| (g / unit).abs().sqrt()));
            pressure = pressure.max((g / unit * reach).abs());
        }
        let columns: Vec<Vec<f64>> = here
            .factor
            .triangle
            .square()
            .into_iter()
            .zip(times(&here.lengths, &scale))
            .map(|(column, factor)| column.into_iter().map(|r| r * factor).collect::<Vec<f64>>())
            .zip(diagonal(&extra))
            .map(|(upper, lower)| upper.into_iter().chain(lower).collect())
            .collect();
        let held: Vec<bool> = distances
            .iter()
            .zip(&here.lengths)
            .map(|(distance, length)| {
                distance.is_some_and(|distance| distance * length <= limits.tolerance * here.reference)
            })
            .collect();
        Self {
            model: Model::new(columns, times(&gradient, &scale)),
            scale,
            share: (1.0 - pressure).max(0.995),
            orthogonality: orthogonality(here, &held),
        }
    }
}

/// Returns the orthogonality with some parameters held.
fn orthogonality(here: &Local, held: &[bool]) -> f64 {
    if !held.contains(&true) {
        return here.orthogonality;
    }
    let free: Vec<Vec<f64>> = here
        .factor
        .triangle
        .square()
        .into_iter()
        .zip(held)
        .filter(|(_, held)| !**held)
        .map(|(column, _)| column)
        .collect();
    match length(&factorize(free, here.factor.projected.clone()).projected) {
        0.0 => 0.0,
        offset => offset / here.reference,
    }
}

#[cfg(test)]
mod tests {
    use super::{Bounds, OracleError, minimize};
    use crate::classical::problem::Limits;
    use crate::classical::{LeastSquaresProblem, LeastSquaresSolution, Reached};

    const LIMITS: Limits = Limits { tolerance: 1e-10, max_steps: 500 };

    /// Rosenbrock's valley: residuals 10(x₂ − x₁²), 1 − x₁.
    struct Valley;

    impl LeastSquaresProblem for Valley {
        fn residuals(&self, x: &[f64]) -> Vec<f64> {
            vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]
        }

        fn jacobian(&self, x: &[f64]) -> Vec<Vec<f64>> {
            vec![vec![-20.0 * x[0], -1.0], vec![10.0, 0.0]]
        }

        fn data_length(&self) -> f64 {
            1.0
        }
    }

    fn valley(start: [f64; 2], low: [f64; 2], high: [f64; 2]) -> LeastSquaresSolution {
        minimize(&Valley, &start, &Bounds::new(low.to_vec(), high.to_vec()).unwrap(), LIMITS).unwrap()
    }

    const OPEN: f64 = f64::INFINITY;

    #[test]
    fn the_free_minimum_is_found() {
        let found = valley([-1.2, 1.0], [-OPEN, -OPEN], [OPEN, OPEN]);
        assert_eq!(found.reached, Reached::Converged, "{found:?}");
        assert!(found.parameters.iter().all(|x| (x - 1.0).abs() < 1e-12), "{found:?}");
    }

    #[test]
    fn bounds_that_do_not_bind_change_nothing() {
        let found = valley([-1.2, 1.0], [-3.0, -3.0], [3.0, 3.0]);
        assert_eq!(found.reached, Reached::Converged, "{found:?}");
        assert!(found.parameters.iter().all(|x| (x - 1.0).abs() < 1e-10), "{found:?}");
    }

    #[test]
    fn a_bound_that_binds_is_met() {
        // At x₁ ≤ 0.8 the valley's floor gives x₂ = 0.64.
        let found = valley([-1.2, 1.0], [-OPEN, -OPEN], [0.8, OPEN]);
        assert_eq!(found.reached, Reached::Converged, "{found:?}");
        assert!(found.parameters[0] < 0.8 && (found.parameters[0] - 0.8).abs() < 1e-10, "{found:?}");
        assert!((found.parameters[1] - 0.64).abs() < 1e-9, "{found:?}");
        // At x₂ ≥ 1.5 the stationary point solves −200·x₁·(1.5 − x₁²) = 1 − x₁.
        let found = valley([2.0, 3.0], [-OPEN, 1.5], [OPEN, OPEN]);
        assert_eq!(found.reached, Reached::Converged, "{found:?}");
        let x = found.parameters[0];
        assert!((found.parameters[1] - 1.5).abs() < 1e-10, "{found:?}");
        assert!((200.0 * x * (1.5 - x * x) + 1.0 - x).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn a_corner_and_starts_on_the_walls() {
        let low = [-OPEN, -OPEN];
        for start in [[-1.2, -1.0], [0.5, 0.1], [5.0, 5.0], [0.0, 0.0]] {
            let found = valley(start, low, [0.5, 0.1]);
            assert_eq!(found.reached, Reached::Converged, "{start:?} {found:?}");
            assert!(found.parameters[0] <= 0.5 && found.parameters[1] <= 0.1, "{found:?}");
            // x₂ is at its bound; x₁ solves −200·x₁·(0.1 − x₁²) = 1 − x₁ inside.
            let x = found.parameters[0];
            assert!((found.parameters[1] - 0.1).abs() < 1e-9, "{found:?}");
            assert!((200.0 * x * (0.1 - x * x) + 1.0 - x).abs() < 1e-5, "{found:?}");
        }
    }

    #[test]
    fn bounds_without_room_are_refused() {
        let message = Bounds::new(vec![0.0, 1.0], vec![1.0, 1.0]).unwrap_err().to_string();
        assert!(message.contains("parameter 2 has no room between its bounds 1 and 1"), "{message}");
        let unequal = Bounds::new(vec![0.0], vec![1.0, 2.0]);
        assert!(matches!(unequal, Err(OracleError::Bounds { parameter: 2, .. })), "{unequal:?}");
        let too_few = minimize(&Valley, &[0.0, 0.0], &Bounds::none(1), LIMITS);
        assert!(matches!(too_few, Err(OracleError::Bounds { parameter: 2, .. })), "{too_few:?}");
    }
}
