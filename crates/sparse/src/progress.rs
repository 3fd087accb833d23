//! Budget of a fit and reports to the observer.

use crate::law::Law;
use crate::scaled::Scaled;
use estimator::{FitContext, Reached, Step, Stop};

/// Reason why a fit has to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Halt {
    /// The budget of steps is spent.
    Spent,
    /// A stop was requested.
    Interrupted,
}

impl Halt {
    /// Returns the reason for the stop after a number of regressions, with the equation so far and advice.
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

/// Counter of a fit's regressions that reports to the observer.
pub struct Progress<'a> {
    context: &'a FitContext<'a>,
    limit: u64,
    steps: u64,
}

impl<'a> Progress<'a> {
    /// Starts at step 0 with the law of no decay. The limit is the smaller of the method's own and the
    /// context's.
    pub fn new(context: &'a FitContext<'a>, own_limit: u64, scaled: &Scaled) -> Self {
        let progress = Self { context, limit: context.step_limit(own_limit), steps: 0 };
        progress.tell(&Law::null(scaled), "start", scaled);
        progress
    }

    /// Returns the number of regressions so far.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Counts one more regression if it is allowed.
    ///
    /// # Errors
    /// [`Halt`] if the budget is spent or a stop was requested.
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

    /// Reports the latest regression to the observer: the mean squared difference in ln A, and λ of the law's
    /// function.
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
