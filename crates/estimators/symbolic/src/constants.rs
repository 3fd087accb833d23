//! Fit of an expression's constants.

use crate::basis::TangentSpace;
use crate::data::Data;
use crate::expression::{Expression, Workspace};
use least_squares::{Descent, Method, gain_ratio};
use nalgebra::{Cholesky, DMatrix, DVector};

/// Method of a fit as far as rounding allows.
pub(crate) const FULL: Method =
    Method { least: 1e-15, max_steps: 300, tolerance: 1e-28, max_rejections: 10, ..Method::NIELSEN };

/// Largest cosine between residuals and derivatives at which the constants count as settled.
const SETTLED: f64 = 1e-9;

/// Result of a fit of the constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fitted {
    /// Loss; infinite if the expression is not finite on every peak.
    pub(crate) loss: f64,
    /// `true` if there are best constants and the fit reached them. An expression that improves as its
    /// constants diverge, such as a·exp(b·x) + c on its way to a line, has none.
    pub(crate) settled: bool,
}

/// Returns the loss of an expression: its mean square error, infinite if it is not finite on every peak.
pub(crate) fn loss(expression: &Expression, data: &Data, workspace: &mut Workspace) -> f64 {
    let values = workspace.values(expression, &data.times);
    let sum: f64 = values.iter().zip(&data.targets).map(|(value, target)| (value - target).powi(2)).sum();
    finite_or_infinite(sum / data.len() as f64)
}

fn finite_or_infinite(loss: f64) -> f64 {
    if loss.is_finite() { loss } else { f64::INFINITY }
}

/// Loss at a point, with the terms that Gauss–Newton needs.
struct Point {
    constants: Vec<f64>,
    loss: f64,
    gradient: DVector<f64>,
    normal: DMatrix<f64>,
}

impl Point {
    fn new(expression: &Expression, data: &Data, workspace: &mut Workspace) -> Option<Self> {
        let constants: Vec<f64> = expression.constants().collect();
        let share = 1.0 / data.len() as f64;
        let values = workspace.values(expression, &data.times);
        let residuals: Vec<f64> = values.iter().zip(&data.targets).map(|(value, z)| value - z).collect();
        let columns = workspace.derivatives(expression, data.len());
        let dot = |a: &[f64], b: &[f64]| share * a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let gradient =
            DVector::from_iterator(columns.len(), columns.iter().map(|column| dot(column, &residuals)));
        let mut normal = DMatrix::zeros(columns.len(), columns.len());
        for (row, one) in columns.iter().enumerate() {
            for (column, other) in columns.iter().enumerate().take(row + 1) {
                let entry = dot(one, other);
                for place in [(row, column), (column, row)] {
                    if let Some(target) = normal.get_mut(place) {
                        *target = entry;
                    }
                }
            }
        }
        let loss = dot(&residuals, &residuals);
        let finite = loss.is_finite() && gradient.iter().chain(&normal).all(|entry| entry.is_finite());
        finite.then_some(Self { constants, loss, gradient, normal })
    }

    /// Returns `true` if the residuals are orthogonal to every derivative, or zero up to rounding.
    fn is_settled(&self, rounding: f64) -> bool {
        self.loss <= rounding || self.steepness() <= SETTLED * SETTLED * self.loss
    }

    /// Returns the squared gradient in units that do not depend on the scaling of the constants.
    fn steepness(&self) -> f64 {
        let scales = self.normal.diagonal();
        let terms = self.gradient.iter().zip(&scales);
        terms.filter(|(_, scale)| **scale > 0.0).map(|(slope, scale)| slope * slope / scale).sum()
    }
}

/// Fits an expression's constants by the Levenberg–Marquardt method from their present values. Marquardt's
/// scaling of the damping moves constants of all sizes. The method's tolerance is on the decrease of the loss that
/// is predicted for a step; see [`gain_ratio`] for the steps that are accepted.
///
/// Reference: Marquardt, SIAM J. Appl. Math. 11 (1963) 431; for fitting constants within genetic programming:
/// Kommenda et al., Genet. Program. Evolvable Mach. 21 (2020) 471.
pub(crate) fn fit_constants(
    expression: &mut Expression,
    data: &Data,
    method: Method,
    workspace: &mut Workspace,
) -> Fitted {
    let start = Point::new(expression, data, workspace).filter(|point| !point.constants.is_empty());
    let Some(mut point) = start else {
        // There are no constants, or the start is not finite.
        let loss = loss(expression, data, workspace);
        return Fitted { loss, settled: expression.constants().next().is_none() };
    };
    let rounding = data.rounding();
    let mut descent = Descent::new(method);
    while point.loss > rounding
        && let Ok(damping) = descent.next_damping()
    {
        let mut damped = point.normal.clone();
        // A constant without effect keeps its value.
        let floor = f64::MIN_POSITIVE.max(1e-30 * damped.diagonal().max());
        for index in 0..damped.nrows() {
            if let Some(entry) = damped.get_mut((index, index)) {
                *entry += damping * entry.max(floor);
            }
        }
        let trial = Cholesky::new(damped).and_then(|factor| {
            let step = -factor.solve(&point.gradient);
            // The predicted decrease ‖r‖² − ‖r + J·s‖² of the damped step s includes the damping once more.
            let scales = point.normal.diagonal().map(|scale| damping * scale.max(floor));
            let predicted = step.dot(&(step.component_mul(&scales) - &point.gradient));
            let moved: Vec<f64> = point.constants.iter().zip(&step).map(|(at, step)| at + step).collect();
            expression.set_constants(&moved);
            let next = Point::new(expression, data, workspace)?;
            let is_flatter = || next.steepness() < point.steepness();
            let ratio = gain_ratio([point.loss, next.loss], predicted, is_flatter)?;
            Some((next, ratio, predicted / point.loss))
        });
        match trial {
            Some((next, ratio, gain)) => {
                point = next;
                descent.accept(ratio, gain);
            }
            None => descent.reject(),
        }
    }
    expression.set_constants(&point.constants);
    Fitted { loss: point.loss, settled: point.is_settled(rounding) }
}

/// Error of an expression on held-out peaks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HeldOut {
    /// Mean square error over the peaks, each left out in turn; infinite if there is no degree of freedom.
    pub(crate) mean: f64,
    /// Standard error of that mean.
    pub(crate) std_error: f64,
}

/// Computes the error with one peak left out in turn, without fitting again: the residual over one minus the
/// leverage. It is exact if the constants enter linearly, and correct to first order otherwise.
///
/// Reference: Allen, Technometrics 16 (1974) 125.
pub(crate) fn held_out(expression: &Expression, data: &Data, workspace: &mut Workspace) -> HeldOut {
    let never = HeldOut { mean: f64::INFINITY, std_error: f64::INFINITY };
    let space = tangent_space(expression, data, workspace);
    let count = data.len();
    if space.rank() >= count {
        return never;
    }
    let leverages = space.leverages(count);
    let values = workspace.values(expression, &data.times).iter().zip(&data.targets);
    let squares: Vec<f64> = values
        .zip(leverages)
        .map(|((value, z), leverage)| ((value - z) / (1.0 - leverage)).powi(2))
        .collect();
    let mean = squares.iter().sum::<f64>() / count as f64;
    let variance = squares.iter().map(|square| (square - mean).powi(2)).sum::<f64>() / (count as f64 - 1.0);
    let std_error = (variance / count as f64).sqrt();
    if mean.is_finite() && std_error.is_finite() { HeldOut { mean, std_error } } else { never }
}

/// Returns the space of the derivatives by the constants.
pub(crate) fn tangent_space(expression: &Expression, data: &Data, workspace: &mut Workspace) -> TangentSpace {
    workspace.values(expression, &data.times);
    TangentSpace::of(data.len(), workspace.derivatives(expression, data.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operators::{Binary, Unary};
    use envelope::Envelope;

    fn data(bend: f64) -> Data {
        let times: Vec<f64> = (0..40).map(|i| 0.3 * f64::from(i)).collect();
        let scatter = |i: usize| (i * 7919 % 101) as f64 / 101.0 - 0.5;
        let logs =
            times.iter().enumerate().map(|(i, t)| 0.4 - 0.2 * t - bend * (0.3 * t).exp() + 0.1 * scatter(i));
        Data::new(&Envelope::new(times.clone(), logs.collect(), 21.0).unwrap()).unwrap()
    }

    fn line() -> Expression {
        let product = Expression::binary(Binary::Multiply, Expression::constant(0.3), &Expression::time());
        Expression::binary(Binary::Add, product, &Expression::constant(-0.2))
    }

    /// Returns a·exp(b·x) + c.
    fn exponential() -> Expression {
        let inner = Expression::binary(Binary::Multiply, Expression::constant(0.5), &Expression::time());
        let scaled = Expression::binary(
            Binary::Multiply,
            Expression::constant(0.1),
            &Expression::unary(Unary::Exp, inner),
        );
        Expression::binary(Binary::Add, scaled, &Expression::constant(0.0))
    }

    #[test]
    fn a_line_is_fitted_to_the_last_digits() {
        let data = data(0.0);
        let mut expression = line();
        let found = fit_constants(&mut expression, &data, FULL, &mut Workspace::default());
        let slope = expression.constants().next().unwrap();
        let expected = data.projected_slope(&data.targets);
        assert!((slope / expected - 1.0).abs() < 1e-14, "{slope} {expected}");
        assert!(found.settled);
        assert_eq!(found.loss, loss(&expression, &data, &mut Workspace::default()));
    }

    #[test]
    fn an_exponential_is_fitted_until_its_residuals_are_orthogonal() {
        let data = data(0.05);
        let (mut expression, mut workspace) = (exponential(), Workspace::default());
        expression.set_constants(&[-0.1, 2.0, 1.0]);
        fit_constants(&mut expression, &data, FULL, &mut workspace);
        let values = workspace.values(&expression, &data.times).to_vec();
        let residuals: Vec<f64> = values.iter().zip(&data.targets).map(|(value, z)| value - z).collect();
        for column in workspace.derivatives(&expression, data.len()) {
            let along: f64 = column.iter().zip(&residuals).map(|(a, b)| a * b).sum();
            let length: f64 = column.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
            assert!((along / length).abs() < 1e-12, "{along:e} {length:e}");
        }
    }

    #[test]
    fn constants_on_their_way_to_infinity_are_not_settled() {
        let (mut expression, mut workspace) = (exponential(), Workspace::default());
        let found = fit_constants(&mut expression, &data(0.05), FULL, &mut workspace);
        assert!(found.loss < 0.05 && !found.settled, "{found:?}");
    }

    #[test]
    fn the_held_out_error_is_that_of_fitting_again() {
        let data = data(0.0);
        let mut workspace = Workspace::default();
        let mut expression = line();
        fit_constants(&mut expression, &data, FULL, &mut workspace);
        let quick = held_out(&expression, &data, &mut workspace);
        let slow: f64 = (0..data.len())
            .map(|left_out| {
                let mut rest = data.clone();
                let (time, target) = (rest.times.remove(left_out), rest.targets.remove(left_out));
                let mut again = line();
                fit_constants(&mut again, &rest, FULL, &mut workspace);
                (workspace.values(&again, &[time])[0] - target).powi(2)
            })
            .sum();
        assert!((quick.mean / (slow / 40.0) - 1.0).abs() < 1e-10);
    }

    #[test]
    fn a_function_outside_of_its_domain_has_an_infinite_loss() {
        let data = data(0.0);
        for (operator, at) in [(Unary::Log, 0.0), (Unary::SquareRoot, -0.5)] {
            let shifted = Expression::binary(Binary::Add, Expression::time(), &Expression::constant(at));
            let mut expression = Expression::unary(operator, shifted);
            let found = fit_constants(&mut expression, &data, FULL, &mut Workspace::default());
            assert_eq!(found.loss, f64::INFINITY, "{operator:?}");
        }
    }
}
