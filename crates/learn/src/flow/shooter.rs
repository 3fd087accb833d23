//! Shooting with a field: prediction of pieces with their Jacobian.

use super::field::Field;
use super::run::Run;
use super::shooting::{Shooter, Shot};
use super::start::State;
use crate::LearnError;
use crate::data::{DataSet, Trajectory};
use dynamics::Hold;

/// Field that predicts pieces.
#[derive(Clone, Copy)]
pub struct FieldShooter<'a> {
    field: &'a dyn Field,
    longest_step_s: f64,
    hold: Hold,
    bound: f64,
}

/// Number of the training part's standard deviations beyond which a position counts as diverged.
const FAR: f64 = 1e3;

impl<'a> FieldShooter<'a> {
    /// Takes longest step, input interpolation and bound from a data set.
    #[must_use]
    pub fn new(field: &'a dyn Field, data: &DataSet) -> Self {
        let bound = data.scale.center.abs() + FAR * data.scale.position;
        Self { field, longest_step_s: data.longest_step_s(), hold: data.hold, bound }
    }
}

impl Shooter for FieldShooter<'_> {
    fn weights(&self) -> usize {
        self.field.weights()
    }

    fn shoot(&self, weights: &[f64], start: State, piece: &Trajectory) -> Result<Shot, LearnError> {
        let run = Run {
            field: self.field,
            weights,
            longest_step_s: self.longest_step_s,
            hold: self.hold,
            bound: self.bound,
        };
        let motion = run.motion(start, piece.times_s(), piece.input(), true)?;
        let pairs = piece.values().iter().zip(&motion.positions);
        Ok(Shot {
            residuals: pairs.map(|(observed, predicted)| observed - predicted).collect(),
            jacobian: motion.sensitivity,
        })
    }
}
