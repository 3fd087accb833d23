//! Levenberg–Marquardt training that is stored through the context of a fit.

use estimator::{FitContext, FitError, Reached, Stop};
use least_squares::{Iteration, LeastSquares, Method, Minimum, State, StopReason};
use nalgebra::DVector;
use serde::Deserialize;
use settings::{Default, Field, Kind};
use std::ops::ControlFlow;

/// Settings of the method.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct LevenbergMarquardt {
    /// Largest number of steps, including rejected ones.
    pub max_steps: u64,
    /// Relative decrease of the loss, both predicted and actual, at which the method has converged. 0
    /// continues until rounding errors dominate.
    pub loss_tolerance: f64,
}

impl LevenbergMarquardt {
    /// Returns the key of the largest number of steps with its default and the default's source.
    #[must_use]
    pub const fn max_steps(default: i64, source: &'static str) -> Field {
        Field::new("max_steps", Kind::Integer { min: 0, max: 1_000_000 }, Default::Integer(default))
            .meaning("Most Levenberg-Marquardt steps.")
            .source(source)
    }

    /// Returns the key of the tolerance with its default and the default's source.
    #[must_use]
    pub const fn loss_tolerance(default: f64, source: &'static str) -> Field {
        Field::new("loss_tolerance", Kind::Float { min: 0.0, max: 0.1 }, Default::Float(default))
            .meaning(
                "Training has converged when a step lowers the loss by a smaller share of itself than \
                    this.",
            )
            .source(source)
    }

    /// Minimizes a sum of squares like [`Method::minimize`], but stores its state through the context and resumes
    /// from a stored one, bit for bit as if it had never stopped.
    ///
    /// # Errors
    /// The error of the problem's evaluation; [`FitError::Checkpoint`] if a state cannot be stored, or if the
    /// stored one does not belong to this method with this start.
    pub fn minimize<P: LeastSquares<Error = FitError>>(
        &self,
        problem: &P,
        start: &DVector<f64>,
        context: &FitContext<'_>,
        observe: impl FnMut(Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<Minimum, FitError> {
        let method = Method { max_steps: self.max_steps, tolerance: self.loss_tolerance, ..Method::NIELSEN };
        let fresh = || State { parameters: start.as_slice().to_vec(), descent: None };
        let state = context.resumed::<State>()?.unwrap_or_else(fresh);
        if let Some(problem) = state.refusal(start.len(), &method) {
            return Err(FitError::Checkpoint { problem });
        }
        method.resume(problem, state, |step, state| context.checkpoint(step, state), observe)
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
}

#[cfg(test)]
mod tests {
    use super::LevenbergMarquardt;
    use crate::kept::Kept;
    use estimator::{Cancel, FitContext, FitError, Silent};
    use least_squares::{LeastSquares, Linearized, Minimum, StopReason};
    use nalgebra::{DMatrix, DVector};
    use seed::Seed;
    use std::ops::ControlFlow;

    /// Residuals p₀² − 2 and p₀·p₁ − 1.
    struct Product;

    impl LeastSquares for Product {
        type Error = FitError;

        fn residuals(&self, p: &DVector<f64>) -> Result<DVector<f64>, FitError> {
            Ok(DVector::from_vec(vec![p[0] * p[0] - 2.0, p[0] * p[1] - 1.0]))
        }

        fn linearize(&self, p: &DVector<f64>) -> Result<Linearized, FitError> {
            let jacobian = DMatrix::from_row_slice(2, 2, &[2.0 * p[0], 0.0, p[1], p[0]]);
            Ok(Linearized { residuals: self.residuals(p)?, jacobian })
        }
    }

    #[test]
    fn stopped_before_any_step_it_goes_on_to_the_same_bits() {
        let method = LevenbergMarquardt { max_steps: 100, loss_tolerance: 0.0 };
        let cancel = Cancel::new();
        let minimize = |kept: &Kept, start: &[f64], most: u64| {
            let context = FitContext::new(Seed::new(0), None, &Silent, &cancel).checkpointing_to(kept);
            method.minimize(&Product, &DVector::from_row_slice(start), &context, |state| {
                if state.step >= most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
        };
        let start = [10.0, -0.5];
        let whole = minimize(&Kept::default(), &start, u64::MAX).unwrap();
        assert!(whole.steps > 5 && whole.loss < 1e-20, "{whole:?}");
        for most in 0..whole.steps {
            let kept = Kept::default();
            let stopped = minimize(&kept, &start, most).unwrap();
            assert_eq!((stopped.reason, stopped.steps), (StopReason::Interrupted, most));
            let refused = minimize(&kept, &[0.0; 3], u64::MAX).unwrap_err();
            assert!(
                matches!(&refused, FitError::Checkpoint { problem } if problem.contains("has 2 parameters, expected 3")),
                "{refused}"
            );
            assert_eq!(minimize(&kept, &start, u64::MAX).unwrap(), whole);
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
