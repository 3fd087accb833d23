//! The budget, and whoever watches.

use crate::law::Law;
use crate::scaled::Scaled;
use estimator::{FitContext, Reached, Step, Stop};

/// Why a fit may go no further.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Halt {
    /// The budget of steps is spent.
    Spent,
    /// Somebody asked to stop.
    Interrupted,
}

impl Halt {
    /// Reason for the stop after a number of regressions, with the equation so far and what to do about it.
    pub fn stop(self, steps: u64, equation: &str) -> Stop {
        match self {
            Self::Spent => Stop {
                reached: Reached::BudgetSpent,
                because: format!(
                    "the budget of {steps} regressions ended before the laws were compared, at {equation}; \
                     raise estimator.max_steps or fit.max_steps"
                ),
            },
            Self::Interrupted => Stop {
                reached: Reached::Interrupted,
                because: format!("interrupted after {steps} regressions, at {equation}"),
            },
        }
    }
}

/// Counts the regressions of a fit and tells whoever watches.
pub struct Progress<'a> {
    context: &'a FitContext<'a>,
    limit: u64,
    steps: u64,
}

impl<'a> Progress<'a> {
    /// Starts at step 0 with the law of no decay; the limit is the smaller of the method's own and the context's.
    pub fn new(context: &'a FitContext<'a>, own_limit: u64, scaled: &Scaled) -> Self {
        let progress = Self { context, limit: context.step_limit(own_limit), steps: 0 };
        progress.tell(&Law::null(scaled), "start", scaled);
        progress
    }

    /// Number of regressions so far.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Leave for one more regression.
    ///
    /// # Errors
    /// [`Halt`] where the budget is spent or somebody asked to stop.
    pub fn advance(&mut self) -> Result<(), Halt> {
        if self.context.is_canceled() {
            return Err(Halt::Interrupted);
        }
        if self.steps >= self.limit {
            return Err(Halt::Spent);
        }
        self.steps += 1;
        Ok(())
    }

    /// Tells of the regression that was last given leave: mean square of the differences in ln A, λ of
    /// the function.
    pub fn tell(&self, law: &Law, phase: &str, scaled: &Scaled) {
        self.context.observe(&Step {
            step: self.steps,
            planned: self.limit,
            phase: phase.to_owned(),
            loss: law.squares / scaled.peaks() as f64,
            decay_rate: scaled.decay_rate(&law.trajectory),
        });
    }
}
