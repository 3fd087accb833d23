//! Fits on pieces that grow from two periods to whole parts.

use crate::data::DataSet;
use crate::flow::{
    Field, FieldShooter, Fit, LENGTHS, Penalty, Shooting, first_guess, fit, longest_as_good, phase_name,
};
use crate::{Context, LearnError};

/// Limits of a progressive fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Largest number of training samples.
    pub samples: usize,
    /// Largest number of steps of each fit.
    pub most_steps: u64,
}

/// Fits a field on growing pieces; each fit starts with the weights of the previous one. Returns the fit
/// chosen by validation error, with the total number of steps.
///
/// # Errors
/// [`LearnError::Diverged`] if even the shortest pieces cannot be followed, [`LearnError::Interrupted`].
pub fn progressive(
    field: &dyn Field,
    data: &DataSet,
    context: &Context<'_>,
    (penalty, progress): (&Penalty, Progress),
    start: Vec<f64>,
    validate: &dyn Fn(&[f64]) -> f64,
) -> Result<(Fit, u64), LearnError> {
    let shooter = FieldShooter::new(field, data);
    let (mut found, mut steps, mut weights): (Vec<(f64, Fit)>, u64, Vec<f64>) = (Vec::new(), 0, start);
    for periods in LENGTHS {
        let pieces = data.training_pieces(data.period_s * periods, progress.samples);
        let phase = phase_name(periods);
        let shooting = Shooting {
            pieces: &pieces,
            noise: data.noise,
            penalty: Some(penalty),
            most_steps: progress.most_steps,
            phase: &phase,
        };
        let starts = pieces.iter().map(|piece| first_guess(piece, data.period_s)).collect();
        match fit(&shooter, &shooting, weights.clone(), starts, context) {
            Ok(own) => {
                steps += own.steps;
                weights.clone_from(&own.weights);
                found.push((validate(&own.weights), own));
            }
            Err(LearnError::Diverged { .. }) if !found.is_empty() => break,
            Err(other) => return Err(other),
        }
    }
    longest_as_good(found).map(|fit| (fit, steps)).ok_or(LearnError::Interrupted)
}
