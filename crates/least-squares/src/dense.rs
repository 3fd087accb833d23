//! The whole method for a dense Jacobian, with a damping that is added to the diagonal (Levenberg 1944).

use crate::descent::{Descent, Method, gain_ratio, is_rounding};
use crate::minimum::{Iteration, Minimum, StopReason};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Residuals and their Jacobian at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearized {
    /// Residuals, one per equation.
    pub residuals: DVector<f64>,
    /// Jacobian, equations × parameters.
    pub jacobian: DMatrix<f64>,
}

/// Sum of squares to be minimized.
pub trait LeastSquares {
    /// Error of an evaluation.
    type Error;

    /// Returns the residuals at a point.
    ///
    /// # Errors
    /// The reason why the problem cannot be evaluated.
    fn residuals(&self, parameters: &DVector<f64>) -> Result<DVector<f64>, Self::Error>;

    /// Returns residuals and Jacobian at a point.
    ///
    /// # Errors
    /// The reason why the problem cannot be evaluated.
    fn linearize(&self, parameters: &DVector<f64>) -> Result<Linearized, Self::Error>;

    /// Returns the parameters after a step, with the optimal values of those that enter the residuals
    /// linearly (variable projection). The default returns them unchanged.
    ///
    /// From such a point, the full step is that of the projected problem in Kaufman's form.
    ///
    /// References: Golub, Pereyra, SIAM J. Numer. Anal. 10 (1973) 413; Kaufman, BIT 15 (1975) 49; Ruhe,
    /// Wedin, SIAM Review 22 (1980) 318.
    ///
    /// # Errors
    /// The reason why the problem cannot be evaluated.
    fn project(&self, parameters: DVector<f64>) -> Result<DVector<f64>, Self::Error> {
        Ok(parameters)
    }
}

/// State from which the method resumes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Parameters.
    pub parameters: Vec<f64>,
    /// Descent; `None` before its first damping is computed from the Jacobian.
    pub descent: Option<Descent>,
}

impl State {
    /// Returns the reason why a method cannot have stored this state for this many parameters; `None` if it can.
    #[must_use]
    pub fn refusal(&self, expected: usize, method: &Method) -> Option<String> {
        let Method { max_steps, max_rejections, .. } = *method;
        let (steps, rejections) = self.descent.map_or((0, 0), |descent| (descent.steps, descent.rejections));
        let found = self.parameters.len();
        let is_own = found == expected && steps <= max_steps && rejections < max_rejections;
        (!is_own).then(|| {
            format!(
                "the saved state has {found} parameters, expected {expected}; it has taken {steps} steps, expected at \
                 most {max_steps}; it continues after {rejections} rejected steps, expected fewer than {max_rejections}"
            )
        })
    }
}

struct Point {
    parameters: DVector<f64>,
    linearized: Linearized,
    gradient: DVector<f64>,
    loss: f64,
}

impl Point {
    fn new<P: LeastSquares>(problem: &P, parameters: DVector<f64>) -> Result<Self, P::Error> {
        let linearized = problem.linearize(&parameters)?;
        let gradient = linearized.jacobian.tr_mul(&linearized.residuals);
        let loss = linearized.residuals.norm_squared();
        Ok(Self { parameters, linearized, gradient, loss })
    }

    /// Returns the point after a step, with the step's gain ratio and the larger of its predicted and actual
    /// decrease, relative to the loss; `None` if the step has to be rejected.
    fn after<P: LeastSquares>(
        &self,
        problem: &P,
        step: &DVector<f64>,
        damping: f64,
    ) -> Result<Option<(Self, f64, f64)>, P::Error> {
        let trial = problem.project(&self.parameters + step)?;
        // ‖r‖² − ‖r + J·s‖² = sᵀ(μ·s − g) for the damped step s.
        let predicted = step.dot(&(step * damping - &self.gradient));
        if is_rounding(self.loss, predicted) {
            let next = Self::new(problem, trial)?;
            let is_flatter = || next.gradient.norm() < self.gradient.norm();
            let ratio = gain_ratio([self.loss, next.loss], predicted, is_flatter);
            return Ok(ratio.map(|ratio| (next, ratio, predicted / self.loss)));
        }
        let loss = problem.residuals(&trial)?.norm_squared();
        let Some(ratio) = gain_ratio([self.loss, loss], predicted, || false) else { return Ok(None) };
        let gain = predicted.max(self.loss - loss) / self.loss;
        Ok(Some((Self::new(problem, trial)?, ratio, gain)))
    }
}

impl Method {
    /// Minimizes a sum of squares from a starting point. The first damping is a share of the largest diagonal entry
    /// of the normal matrix, and each one is added to all of them. `observe` gets the start and the state after every
    /// step, and may stop the method. See [`gain_ratio`] for the steps that are accepted.
    ///
    /// # Errors
    /// The error of the problem's evaluation.
    pub fn minimize<P: LeastSquares>(
        &self,
        problem: &P,
        start: &DVector<f64>,
        observe: impl FnMut(Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<Minimum, P::Error> {
        let from = State { parameters: start.as_slice().to_vec(), descent: None };
        self.resume(problem, from, |_, _| Ok(()), observe)
    }

    /// Continues like [`minimize`](Self::minimize) from a state, bit for bit as if it had never stopped. `keep`
    /// gets the number of steps and the state before every step.
    ///
    /// # Errors
    /// The error of the problem's evaluation or of `keep`.
    pub fn resume<P: LeastSquares>(
        &self,
        problem: &P,
        from: State,
        keep: impl Fn(u64, &dyn Fn() -> State) -> Result<(), P::Error>,
        mut observe: impl FnMut(Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<Minimum, P::Error> {
        let mut point = Point::new(problem, DVector::from_vec(from.parameters))?;
        let mut normal = Normal::new(&point.linearized.jacobian);
        let first = || Descent::new(Method { first: self.first * normal.largest_diagonal(), ..*self });
        let mut descent = Descent { method: *self, ..from.descent.unwrap_or_else(first) };
        let reason = loop {
            let parameters = || point.parameters.as_slice().to_vec();
            keep(descent.steps, &|| State { parameters: parameters(), descent: Some(descent) })?;
            let state = Iteration { step: descent.steps, parameters: &point.parameters, loss: point.loss };
            if observe(state).is_break() {
                break StopReason::Interrupted;
            }
            if !point.loss.is_finite() {
                break StopReason::NotFinite;
            }
            let damping = match descent.next_damping() {
                Ok(damping) => damping,
                Err(reason) => break reason,
            };
            let next = match normal.solve(&point, damping) {
                Some(step) => point.after(problem, &step, damping)?,
                None => None,
            };
            if let Some((next, ratio, gain)) = next {
                point = next;
                normal = Normal::new(&point.linearized.jacobian);
                descent.accept(ratio, gain);
            } else {
                descent.reject();
                if descent.is_stationary() {
                    break StopReason::Stationary;
                }
            }
        };
        let Descent { steps, last_gain, .. } = descent;
        Ok(Minimum { last_gain, loss: point.loss, parameters: point.parameters, steps, reason })
    }
}

/// Normal matrix, formed on the smaller side of the Jacobian.
enum Normal {
    /// JᵀJ, parameters × parameters.
    Parameters(DMatrix<f64>),
    /// J·Jᵀ, equations × equations: (JᵀJ + μ)⁻¹Jᵀ = Jᵀ(J·Jᵀ + μ)⁻¹.
    Equations(DMatrix<f64>),
}

impl Normal {
    fn new(jacobian: &DMatrix<f64>) -> Self {
        if jacobian.nrows() < jacobian.ncols() {
            Self::Equations(jacobian * jacobian.transpose())
        } else {
            Self::Parameters(jacobian.tr_mul(jacobian))
        }
    }

    fn largest_diagonal(&self) -> f64 {
        let (Self::Parameters(matrix) | Self::Equations(matrix)) = self;
        matrix.diagonal().max()
    }

    /// Returns the step −(JᵀJ + μ)⁻¹·Jᵀr; `None` if the damped matrix is not positive definite up to
    /// rounding.
    fn solve(&self, point: &Point, damping: f64) -> Option<DVector<f64>> {
        let factor = |matrix: &DMatrix<f64>| -> Option<Cholesky<f64, Dyn>> {
            Cholesky::new(matrix + DMatrix::from_diagonal_element(matrix.nrows(), matrix.ncols(), damping))
        };
        Some(match self {
            Self::Parameters(matrix) => -factor(matrix)?.solve(&point.gradient),
            Self::Equations(matrix) => {
                let weights = factor(matrix)?.solve(&point.linearized.residuals);
                -point.linearized.jacobian.tr_mul(&weights)
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{LeastSquares, Linearized, State};
    use crate::descent::{Descent, Method};
    use crate::minimum::StopReason;
    use nalgebra::{DMatrix, DVector};
    use std::convert::Infallible;
    use std::ops::ControlFlow;

    const METHOD: Method = Method { max_steps: 100, ..Method::NIELSEN };

    /// One equation in three unknowns.
    struct Plane;

    impl LeastSquares for Plane {
        type Error = Infallible;

        fn residuals(&self, p: &DVector<f64>) -> Result<DVector<f64>, Infallible> {
            Ok(DVector::from_vec(vec![p[0] + 2.0 * p[1] + 3.0 * p[2] - 7.0]))
        }

        fn linearize(&self, p: &DVector<f64>) -> Result<Linearized, Infallible> {
            let jacobian = DMatrix::from_row_slice(1, 3, &[1.0, 2.0, 3.0]);
            Ok(Linearized { residuals: self.residuals(p)?, jacobian })
        }
    }

    #[test]
    fn stops_at_a_minimum_or_when_asked_or_when_spent() {
        for (last, max_steps, reason) in [
            (u64::MAX, 100, StopReason::Stationary),
            (2, 100, StopReason::Interrupted),
            (u64::MAX, 2, StopReason::StepsSpent),
        ] {
            let method = Method { max_steps, ..METHOD };
            let Ok(found) = method.minimize(&Plane, &DVector::zeros(3), |state| {
                if state.step == last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            assert_eq!((found.reason, found.steps == 2), (reason, reason != StopReason::Stationary));
            assert_eq!(found.loss < 1e-20, reason == StopReason::Stationary, "{found:?}");
        }
    }

    #[test]
    fn refuses_a_state_that_it_cannot_have_stored() {
        let state = |steps, rejections| {
            let descent = Descent { steps, rejections, ..Descent::new(METHOD) };
            State { parameters: vec![1.0, 0.5], descent: Some(descent) }
        };
        assert_eq!(state(100, 11).refusal(2, &METHOD), None);
        for (state, count, says) in [
            (state(0, 0), 3, "has 2 parameters, expected 3"),
            (state(101, 0), 2, "has taken 101 steps, expected at most 100"),
            (state(0, 12), 2, "after 12 rejected steps, expected fewer than 12"),
        ] {
            let refusal = state.refusal(count, &METHOD).unwrap();
            assert!(refusal.contains(says), "{refusal}");
        }
    }
}
