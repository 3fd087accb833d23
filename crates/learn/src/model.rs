//! Models and their predictions.

use crate::{LearnError, Stored};
use serde::{Deserialize, Serialize};

/// Past that a prediction starts from.
#[derive(Debug, Clone, Copy)]
pub struct Past<'a> {
    /// Times in seconds, strictly increasing.
    pub times_s: &'a [f64],
    /// Observed positions, one per time.
    pub values: &'a [f64],
    /// Input at each time; `None` for a free motion.
    pub input: Option<&'a [f64]>,
}

/// Times to predict, all after the past, with the input there.
#[derive(Debug, Clone, Copy)]
pub struct Ahead<'a> {
    /// Times in seconds, strictly increasing.
    pub times_s: &'a [f64],
    /// Input at each time; `None` for a free motion.
    pub input: Option<&'a [f64]>,
}

/// A prediction.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Predicted {
    /// Positions, one per time ahead.
    pub values: Vec<f64>,
    /// Standard deviation of a measured position about each predicted one; `None` if the model states none.
    pub std: Option<Vec<f64>>,
}

/// State at which a torque acts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Position.
    pub position: f64,
    /// Velocity.
    pub velocity: f64,
    /// Direction of the motion, 1 or −1; at rest, the direction in which it would continue.
    pub direction: f64,
    /// Input; 0 without an input.
    pub input: f64,
}

/// Torque divided by the inertia, which is the acceleration it causes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Torque {
    /// Acceleration in rad/s² or m/s².
    pub value: f64,
    /// Standard deviation of the acceleration; `None` if the model states none.
    pub std: Option<f64>,
}

/// Physical coefficient of a learned law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Coefficient {
    /// Term that the coefficient multiplies, such as `theta^3`.
    pub name: String,
    /// Value: acceleration per unit of the term.
    pub value: f64,
    /// Unit of the value.
    pub unit: String,
    /// Standard error; `None` if none is stated.
    pub std_error: Option<f64>,
    /// Share of the ensemble's members that include the term; `None` without an ensemble.
    pub inclusion: Option<f64>,
}

impl Coefficient {
    /// Returns the 95 % interval; `None` without a standard error.
    #[must_use]
    pub fn interval_95(&self) -> Option<[f64; 2]> {
        self.std_error.map(|error| [self.value - 1.96 * error, self.value + 1.96 * error])
    }
}

/// Model of the motion. The same arguments give the same bits.
pub trait Model: Send + Sync {
    /// Predicts from a past without further observations. The past has at least [`LEAST_PAST`](crate::data::LEAST_PAST) samples.
    ///
    /// # Errors
    /// [`LearnError::Diverged`] if the motion diverges, other errors if the model cannot run.
    fn free_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError>;

    /// Predicts as [`Self::free_run`] does, with standard deviations if the model states them.
    ///
    /// # Errors
    /// As [`Self::free_run`].
    fn banded_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        self.free_run(past, ahead)
    }

    /// Returns the number of trained parameters.
    fn parameters(&self) -> usize;

    /// Returns the coefficients of the law; empty if the model states none.
    fn coefficients(&self) -> &[Coefficient] {
        &[]
    }

    /// Returns the sum of all torques divided by the inertia at a state; `None` if it is not a function of
    /// the state.
    fn torque(&self, _place: &Place) -> Option<Torque> {
        None
    }

    /// Returns the free-run error on the validation part, in the unit of the positions, of the model as it was chosen;
    /// `None` unless the chosen model was fitted to that part afterwards, so that its own error there tells nothing.
    fn validation(&self) -> Option<f64> {
        None
    }

    /// Returns the law as text; `None` if the model is not an equation.
    fn equation(&self) -> Option<String> {
        None
    }

    /// Returns the model for storage in a file; `None` for a baseline that is not stored.
    fn stored(&self) -> Option<Stored> {
        None
    }
}
