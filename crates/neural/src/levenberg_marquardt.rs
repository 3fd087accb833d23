//! Nonlinear least squares by the Levenberg–Marquardt method.
//!
//! Reference: Marquardt, SIAM J. Appl. Math. 11 (1963) 431; the damping update of Nielsen, report
//! IMM-REP-1999-05 (DTU 1999); the stopping test of MINPACK: Moré, Garbow, Hillstrom, report ANL-80-74
//! (1980).

use crate::minimum::{Iteration, Minimum, StopReason};
use estimator::{FitContext, FitError, Reached, Stop};
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

/// Settings of the method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevenbergMarquardt {
    /// Largest number of steps, including rejected ones.
    pub max_steps: u64,
    /// Relative decrease of the loss, both predicted and actual, at which the method has converged. 0
    /// continues until rounding errors dominate.
    pub loss_tolerance: f64,
}

/// Predicted relative decrease of the loss below which rounding errors hide the actual one.
const ROUNDING_SHARE: f64 = 1e-10;

/// Number of successive rejected steps after which the point counts as stationary.
const MOST_REJECTIONS: u32 = 12;

struct Point {
    parameters: DVector<f64>,
    linearized: Linearized,
    gradient: DVector<f64>,
    loss: f64,
}

/// State from which the method resumes, except for what follows from the parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct State {
    parameters: Vec<f64>,
    steps: u64,
    /// `None` before the first step: it is then computed from the Jacobian.
    damping: Option<f64>,
    growth: f64,
    rejections: u32,
    last_gain: f64,
}

impl State {
    fn at(start: DVector<f64>) -> Self {
        Self {
            parameters: start.as_slice().to_vec(),
            steps: 0,
            damping: None,
            growth: 2.0,
            rejections: 0,
            last_gain: f64::INFINITY,
        }
    }

    /// Returns the reason why a minimization with this many parameters and at most this many steps cannot
    /// have stored this state; `None` if it can.
    fn refusal(&self, parameters: usize, max_steps: u64) -> Option<String> {
        let (found, steps, rejections) = (self.parameters.len(), self.steps, self.rejections);
        if found != parameters {
            return Some(format!("the saved state has {found} parameters, expected {parameters}"));
        }
        if steps > max_steps {
            return Some(format!("the saved state has taken {steps} steps, expected at most {max_steps}"));
        }
        (rejections >= MOST_REJECTIONS).then(|| {
            format!(
                "the saved state continues after {rejections} rejected steps, expected fewer than \
                 {MOST_REJECTIONS}"
            )
        })
    }
}

/// Accepted step.
struct Accepted {
    next: Point,
    /// Actual over predicted decrease, at most 1.
    gain: f64,
    /// Larger of predicted and actual decrease, relative to the loss.
    share: f64,
}

impl Point {
    fn new<P: LeastSquares>(problem: &P, parameters: DVector<f64>) -> Result<Self, P::Error> {
        let linearized = problem.linearize(&parameters)?;
        let gradient = linearized.jacobian.tr_mul(&linearized.residuals);
        let loss = linearized.residuals.norm_squared();
        Ok(Self { parameters, linearized, gradient, loss })
    }
}

impl LevenbergMarquardt {
    /// Minimizes a sum of squares from a starting point. `observe` gets the start and the state after every
    /// step, and may stop the method.
    ///
    /// Far from the minimum, a step is accepted if it lowers the loss. Near the minimum, where rounding hides
    /// the change of the loss, it is accepted if it lowers the norm of the gradient: the loss is flat to
    /// rounding over half the digits of the parameters, the gradient is not.
    ///
    /// # Errors
    /// The error of the problem's evaluation.
    pub fn minimize<P: LeastSquares>(
        &self,
        problem: &P,
        start: DVector<f64>,
        observe: impl FnMut(Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<Minimum, P::Error> {
        self.go_on(problem, State::at(start), |_, _| Ok(()), observe)
    }

    /// Minimizes like [`minimize`](Self::minimize), but stores its state through the context and resumes from
    /// a stored one, bit for bit as if it had never stopped.
    ///
    /// # Errors
    /// The error of the problem's evaluation; [`FitError::Checkpoint`] if a state cannot be stored, or if the
    /// stored one does not belong to this method with this start.
    pub fn minimize_resumably<P: LeastSquares<Error = FitError>>(
        &self,
        problem: &P,
        start: DVector<f64>,
        context: &FitContext<'_>,
        observe: impl FnMut(Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<Minimum, FitError> {
        let fresh = State::at(start);
        let state = context.resumed::<State>()?.unwrap_or_else(|| fresh.clone());
        if let Some(problem) = state.refusal(fresh.parameters.len(), self.max_steps) {
            return Err(FitError::Checkpoint { problem });
        }
        self.go_on(problem, state, |step, state| context.checkpoint(step, state), observe)
    }

    fn go_on<P: LeastSquares>(
        &self,
        problem: &P,
        from: State,
        keep: impl Fn(u64, &dyn Fn() -> State) -> Result<(), P::Error>,
        mut observe: impl FnMut(Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<Minimum, P::Error> {
        let State { parameters, mut steps, damping, mut growth, mut rejections, mut last_gain } = from;
        let mut point = Point::new(problem, DVector::from_vec(parameters))?;
        let mut normal = Normal::new(&point.linearized.jacobian);
        let mut damping = damping.unwrap_or_else(|| 1e-3 * normal.largest_diagonal());
        let reason = loop {
            keep(steps, &|| State {
                parameters: point.parameters.as_slice().to_vec(),
                steps,
                damping: Some(damping),
                growth,
                rejections,
                last_gain,
            })?;
            let state = Iteration { step: steps, parameters: &point.parameters, loss: point.loss };
            if observe(state).is_break() {
                break StopReason::Interrupted;
            }
            if !point.loss.is_finite() {
                break StopReason::NotFinite;
            }
            if last_gain <= self.loss_tolerance {
                break StopReason::Settled;
            }
            if steps >= self.max_steps {
                break StopReason::StepsSpent;
            }
            steps += 1;
            let trial = normal.solve(&point, damping).map(|step| (&point.parameters + &step, step));
            let accepted = match trial {
                Some((trial, step)) => self.try_step(problem, &point, trial, &step, damping)?,
                None => None,
            };
            match accepted {
                Some(Accepted { next, gain, share }) => {
                    point = next;
                    last_gain = share;
                    normal = Normal::new(&point.linearized.jacobian);
                    damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
                    growth = 2.0;
                    rejections = 0;
                }
                None => {
                    damping *= growth;
                    growth *= 2.0;
                    rejections += 1;
                    if rejections >= MOST_REJECTIONS {
                        break StopReason::Stationary;
                    }
                }
            }
        };
        Ok(Minimum { last_gain, loss: point.loss, parameters: point.parameters, steps, reason })
    }

    /// Describes a minimum of this method for an estimate: the outcome of the fit and the reason why it
    /// stopped.
    #[must_use]
    pub fn stop(minimum: &Minimum) -> Stop {
        let steps = minimum.steps;
        let (reached, because) = match minimum.reason {
            StopReason::Settled => (
                Reached::Converged,
                format!("the last step lowered the loss by {:.0e} of itself", minimum.last_gain),
            ),
            StopReason::Stationary => {
                (Reached::Converged, "no step lowers the loss or its gradient any more".to_owned())
            }
            StopReason::StepsSpent => (
                Reached::BudgetSpent,
                format!("the budget of {steps} steps ended; raise estimator.max_steps or fit.max_steps"),
            ),
            StopReason::NotFinite => (
                Reached::Diverged,
                format!("the loss is not finite after {steps} steps; lower estimator.initial_scale"),
            ),
            StopReason::Interrupted => (Reached::Interrupted, format!("interrupted after {steps} steps")),
        };
        Stop { reached, because }
    }

    /// Returns the point after a step; `None` if it is worse.
    fn try_step<P: LeastSquares>(
        &self,
        problem: &P,
        point: &Point,
        trial: DVector<f64>,
        step: &DVector<f64>,
        damping: f64,
    ) -> Result<Option<Accepted>, P::Error> {
        let trial = problem.project(trial)?;
        // ‖r‖² − ‖r + J·s‖² = sᵀ(μ·s − g) for the damped step s.
        let predicted = step.dot(&(step * damping - &point.gradient));
        if predicted <= ROUNDING_SHARE * point.loss {
            let next = Point::new(problem, trial)?;
            let flatter = next.gradient.norm() < point.gradient.norm();
            let no_worse = next.loss <= point.loss * (1.0 + ROUNDING_SHARE);
            let share = predicted / point.loss;
            return Ok((flatter && no_worse).then_some(Accepted { next, gain: 1.0, share }));
        }
        let loss = problem.residuals(&trial)?.norm_squared();
        if loss.is_finite() && loss < point.loss {
            let gain = ((point.loss - loss) / predicted).min(1.0);
            let share = predicted.max(point.loss - loss) / point.loss;
            return Ok(Some(Accepted { next: Point::new(problem, trial)?, gain, share }));
        }
        Ok(None)
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
    use super::{LeastSquares, LevenbergMarquardt, Linearized, MOST_REJECTIONS, Minimum, State, StopReason};
    use crate::kept::Kept;
    use estimator::{Cancel, FitContext, FitError, Silent};
    use nalgebra::{DMatrix, DVector};
    use seed::Seed;
    use std::convert::Infallible;
    use std::ops::ControlFlow;

    /// y = p₀·exp(−p₁·t) through points that are not on any such curve.
    struct Decay;

    const POINTS: [(f64, f64); 5] = [(0.0, 2.1), (1.0, 1.2), (2.0, 0.6), (3.0, 0.5), (4.0, 0.1)];

    impl LeastSquares for Decay {
        type Error = Infallible;

        fn residuals(&self, p: &DVector<f64>) -> Result<DVector<f64>, Infallible> {
            Ok(DVector::from_iterator(POINTS.len(), POINTS.iter().map(|(t, y)| p[0] * (-p[1] * t).exp() - y)))
        }

        fn linearize(&self, p: &DVector<f64>) -> Result<Linearized, Infallible> {
            let jacobian = DMatrix::from_fn(POINTS.len(), 2, |row, column| {
                let t = POINTS[row].0;
                let e = (-p[1] * t).exp();
                if column == 0 { e } else { -p[0] * t * e }
            });
            Ok(Linearized { residuals: self.residuals(p)?, jacobian })
        }
    }

    const METHOD: LevenbergMarquardt = LevenbergMarquardt { max_steps: 100, loss_tolerance: 0.0 };

    #[test]
    fn it_reaches_a_minimum_with_residuals_to_the_last_digits() {
        let far = DVector::from_vec(vec![10.0, -0.5]);
        let near = DVector::from_vec(vec![2.0, 0.5]);
        let go = |start| METHOD.minimize(&Decay, start, |_| ControlFlow::Continue(())).unwrap();
        let (one, other) = (go(far), go(near));
        assert_eq!(one.reason, StopReason::Stationary);
        assert!((&one.parameters - &other.parameters).norm() < 1e-12, "{one:?} {other:?}");
        assert!(one.loss > 0.01);
    }

    #[test]
    fn it_stops_when_asked_and_when_spent() {
        let start = DVector::from_vec(vec![10.0, -0.5]);
        let stopped = METHOD.minimize(&Decay, start.clone(), |state| {
            if state.step == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        let stopped = stopped.unwrap();
        assert_eq!((stopped.reason, stopped.steps), (StopReason::Interrupted, 2));
        let none = LevenbergMarquardt { max_steps: 0, ..METHOD };
        let untouched = none.minimize(&Decay, start.clone(), |_| ControlFlow::Continue(())).unwrap();
        assert_eq!((untouched.reason, untouched.parameters), (StopReason::StepsSpent, start));
    }

    #[test]
    fn fewer_equations_than_parameters_are_solved_as_well() {
        struct Line;
        impl LeastSquares for Line {
            type Error = Infallible;
            fn residuals(&self, p: &DVector<f64>) -> Result<DVector<f64>, Infallible> {
                Ok(DVector::from_vec(vec![p[0] + 2.0 * p[1] + 3.0 * p[2] - 7.0]))
            }
            fn linearize(&self, p: &DVector<f64>) -> Result<Linearized, Infallible> {
                let jacobian = DMatrix::from_row_slice(1, 3, &[1.0, 2.0, 3.0]);
                Ok(Linearized { residuals: self.residuals(p)?, jacobian })
            }
        }
        let minimum = METHOD.minimize(&Line, DVector::zeros(3), |_| ControlFlow::Continue(())).unwrap();
        assert!(minimum.loss < 1e-20, "{minimum:?}");
    }

    /// [`Decay`] with the error type of a fallible evaluation.
    struct Fallible;

    impl LeastSquares for Fallible {
        type Error = FitError;

        fn residuals(&self, p: &DVector<f64>) -> Result<DVector<f64>, FitError> {
            let Ok(residuals) = Decay.residuals(p);
            Ok(residuals)
        }

        fn linearize(&self, p: &DVector<f64>) -> Result<Linearized, FitError> {
            let Ok(linearized) = Decay.linearize(p);
            Ok(linearized)
        }
    }

    #[test]
    fn stopped_before_any_step_it_goes_on_to_the_same_bits() {
        let cancel = Cancel::new();
        let minimize = |kept: &Kept, most: u64| {
            let context = FitContext::new(Seed::new(0), None, &Silent, &cancel).checkpointing_to(kept);
            let mut told = Vec::new();
            let start = DVector::from_vec(vec![10.0, -0.5]);
            let minimum = METHOD.minimize_resumably(&Fallible, start, &context, |state| {
                told.push((state.step, state.loss.to_bits()));
                if state.step >= most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            (minimum.unwrap(), told)
        };
        let (whole, told) = minimize(&Kept::default(), u64::MAX);
        assert!(whole.steps > 15, "{whole:?}");
        for most in 0..whole.steps {
            let kept = Kept::default();
            let (stopped, before) = minimize(&kept, most);
            assert_eq!((stopped.reason, stopped.steps), (StopReason::Interrupted, most));
            let (resumed, after) = minimize(&kept, u64::MAX);
            assert_eq!(resumed, whole);
            // The step before which the state was stored is reported again.
            assert_eq!([&before[..before.len() - 1], &after].concat(), told);
        }
        // A state of another problem is refused.
        let kept = Kept::default();
        minimize(&kept, 3);
        let context = FitContext::new(Seed::new(0), None, &Silent, &cancel).checkpointing_to(&kept);
        let other =
            METHOD.minimize_resumably(&Fallible, DVector::zeros(3), &context, |_| ControlFlow::Continue(()));
        assert!(other.unwrap_err().to_string().contains("has 2 parameters, expected 3"));
    }

    #[test]
    fn what_it_cannot_have_kept_is_refused() {
        let cancel = Cancel::new();
        let go_on = |state: State| {
            let kept = Kept::default();
            let context = FitContext::new(Seed::new(0), None, &Silent, &cancel).checkpointing_to(&kept);
            context.checkpoint(state.steps, || state).unwrap();
            let start = DVector::from_vec(vec![10.0, -0.5]);
            METHOD.minimize_resumably(&Fallible, start, &context, |_| ControlFlow::Continue(()))
        };
        let state = State::at(DVector::from_vec(vec![1.0, 0.5]));
        let last = State { steps: METHOD.max_steps, rejections: MOST_REJECTIONS - 1, ..state.clone() };
        assert_eq!(go_on(last).unwrap().reason, StopReason::StepsSpent);
        for (state, says) in [
            (
                State { steps: METHOD.max_steps + 1, ..state.clone() },
                "has taken 101 steps, expected at most 100",
            ),
            (State { steps: u64::MAX, ..state.clone() }, "expected at most 100"),
            (
                State { rejections: MOST_REJECTIONS, ..state.clone() },
                "after 12 rejected steps, expected fewer than 12",
            ),
            (State { rejections: u32::MAX, ..state }, "expected fewer than 12"),
        ] {
            let refused = go_on(state).unwrap_err();
            assert!(
                matches!(&refused, FitError::Checkpoint { problem } if problem.contains(says)),
                "{refused}"
            );
        }
    }

    #[test]
    fn every_stop_has_its_sentence() {
        let minimum =
            |reason| Minimum { parameters: DVector::zeros(1), loss: 1.0, last_gain: 2e-9, steps: 7, reason };
        for (reason, reached, because) in [
            (StopReason::Settled, "converged", "the last step lowered the loss by 2e-9 of itself"),
            (StopReason::Stationary, "converged", "no step lowers the loss or its gradient any more"),
            (
                StopReason::StepsSpent,
                "budget_spent",
                "the budget of 7 steps ended; raise estimator.max_steps or fit.max_steps",
            ),
            (
                StopReason::NotFinite,
                "diverged",
                "the loss is not finite after 7 steps; lower estimator.initial_scale",
            ),
            (StopReason::Interrupted, "interrupted", "interrupted after 7 steps"),
        ] {
            let stop = LevenbergMarquardt::stop(&minimum(reason));
            assert_eq!((stop.reached.name(), stop.because.as_str()), (reached, because));
        }
    }
}
