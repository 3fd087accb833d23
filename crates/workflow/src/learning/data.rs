//! Records as data sets.

use experiment::LearningProblem;
use learn::LearnError;
use learn::data::Trajectory;
use record::{Quantity, Record};

/// Checks that a record can be learned from beside others: positions, in one unit. `first` holds the first record's name and unit.
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

/// One sample of so many, on the clock that is believed, counted from its first.
///
/// # Errors
/// As [`Trajectory::new`].
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
    // Without a sample there is no time to count from.
    let first = times_s.first().copied().unwrap_or_default();
    let times = thin(times_s).iter().map(|time| time - first).collect();
    let input = record.input().map(|input| thin(&centered(input)));
    Trajectory::new(name, times, thin(&centered(record.values())), input)
}
