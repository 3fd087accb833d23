//! Data sets made of records.

#![allow(clippy::indexing_slicing, reason = "the closure runs only if there are times")]

use experiment::LearningProblem;
use learn::LearnError;
use learn::data::Trajectory;
use record::{Quantity, Record};

/// Checks that a record can be learned from together with others: it must hold positions, all in one unit.
/// `first` holds the first record's name and unit.
///
/// # Errors
/// [`LearnError::NoPosition`] and [`LearnError::MixedUnits`].
pub fn check_record(
    name: &str,
    record: &Record,
    first: &mut Option<(String, &'static str)>,
) -> Result<(), LearnError> {
    if record.quantity() != Quantity::Position {
        let quantity = if record.quantity() == Quantity::Velocity { "velocity" } else { "acceleration" };
        return Err(LearnError::NoPosition { record: name.to_owned(), quantity });
    }
    let (first_name, first_unit) = first.get_or_insert_with(|| (name.to_owned(), record.unit()));
    if *first_unit != record.unit() {
        return Err(LearnError::MixedUnits {
            first: first_name.clone(),
            first_unit: (*first_unit).to_owned(),
            other: name.to_owned(),
            other_unit: record.unit().to_owned(),
        });
    }
    Ok(())
}

/// Builds a trajectory from every n-th sample of a record (`every` of the problem). Times are those of the
/// believed clock, counted from its first sample.
///
/// # Errors
/// Same as [`Trajectory::new`].
pub fn trajectory(
    problem: &LearningProblem,
    name: &str,
    record: &Record,
    times_s: &[f64],
) -> Result<Trajectory, LearnError> {
    let centered = |values: &[f64]| -> Vec<f64> {
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        values.iter().map(|value| if problem.remove_mean { value - mean } else { *value }).collect()
    };
    let thin = |values: &[f64]| values.iter().step_by(problem.every).copied().collect::<Vec<f64>>();
    let times = thin(times_s).iter().map(|time| time - times_s[0]).collect();
    let input = record.input().map(|input| thin(&centered(input)));
    Trajectory::new(name, times, thin(&centered(record.values())), input)
}
