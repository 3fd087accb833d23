//! What a learned model gives.

use crate::{LearnError, Stored};
use serde::{Deserialize, Serialize};

/// The past that a prediction starts from.
#[derive(Debug, Clone, Copy)]
pub struct Past<'a> {
    /// Times in seconds, strictly increasing.
    pub times_s: &'a [f64],
    /// Observed positions, one for each time.
    pub values: &'a [f64],
    /// The input at each time, where there is one.
    pub input: Option<&'a [f64]>,
}

/// Times to predict at, all after the past, with the input there.
#[derive(Debug, Clone, Copy)]
pub struct Ahead<'a> {
    /// Times in seconds, strictly increasing.
    pub times_s: &'a [f64],
    /// The input at each time, where there is one.
    pub input: Option<&'a [f64]>,
}

/// A prediction.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Predicted {
    /// Positions, one for each time ahead.
    pub values: Vec<f64>,
    /// Standard deviations of a measured position about each, where the model states them.
    pub std: Option<Vec<f64>>,
}

/// A point at which a torque acts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Position.
    pub position: f64,
    /// Velocity.
    pub velocity: f64,
    /// Direction of the motion, 1 or −1; at rest that in which it would go on.
    pub direction: f64,
    /// Input; 0 without one.
    pub input: f64,
}

/// A torque over the inertia, the acceleration it causes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Torque {
    /// Acceleration in rad/s² or m/s².
    pub value: f64,
    /// Its standard deviation, where the model states one.
    pub std: Option<f64>,
}

/// A physical coefficient of a learned law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Coefficient {
    /// The term that it multiplies, such as `theta^3`.
    pub name: String,
    /// Its value: the term's acceleration per unit of the term.
    pub value: f64,
    /// Its unit.
    pub unit: String,
    /// Standard error, where one is stated.
    pub std_error: Option<f64>,
    /// Share of the ensemble's members that have the term, where there is an ensemble.
    pub inclusion: Option<f64>,
}

impl Coefficient {
    /// 95 % interval, where a standard error is stated.
    #[must_use]
    pub fn interval_95(&self) -> Option<[f64; 2]> {
        self.std_error.map(|error| [self.value - 1.96 * error, self.value + 1.96 * error])
    }
}

/// A model of the motion. The same arguments give the same bits.
pub trait Model: Send + Sync {
    /// Predicts from a past without seeing another observation; the past is at least eight samples.
    ///
    /// # Errors
    /// [`LearnError::Diverged`] where the motion runs away, others where the model cannot run.
    fn free_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError>;

    /// As [`Self::free_run`], with standard deviations where the model states them.
    ///
    /// # Errors
    /// As [`Self::free_run`].
    fn banded_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        self.free_run(past, ahead)
    }

    /// Trained numbers.
    fn parameters(&self) -> usize;

    /// Coefficients of a law, where the model is one.
    fn coefficients(&self) -> &[Coefficient] {
        &[]
    }

    /// All torques over the inertia at a point, where they are a function of it.
    fn torque(&self, _place: &Place) -> Option<Torque> {
        None
    }

    /// The law as text, where the model is one.
    fn equation(&self) -> Option<String> {
        None
    }

    /// The model for a file; `None` for a baseline that is not kept.
    fn stored(&self) -> Option<Stored> {
        None
    }
}
