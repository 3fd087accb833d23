//! Messages on a method of another kind: a learner where an estimator is expected, and the reverse.

use super::{SweepCommandError, TrainerError};
use experiment::sweep::SweepError;
use learn::learners::find;
use oracle::classical::CLASSICAL;
use registry::ESTIMATORS;
use settings::SettingsError;

/// Says of an unknown name what it is and how to run it, if it names a method of the other kind.
fn of_other_kind(error: SettingsError) -> SettingsError {
    let SettingsError::UnknownName { origin, what, found, .. } = &error else { return error };
    let is_estimator = || {
        ESTIMATORS.iter().any(|entry| entry.id == *found) || CLASSICAL.iter().any(|route| route.id == found)
    };
    let (is, remedy) = match what.as_str() {
        "method" | "estimator" if find(found).is_some() => (
            format!("a learner of dynamics and no {what} of a decay"),
            format!("run it with `trainer configs/learn.toml learn.learners={found}`"),
        ),
        "learner" if is_estimator() => (
            "an estimator of the damping and no learner of dynamics".to_owned(),
            format!(
                "run it with `trainer configs/pinn.toml estimator={found}`, or beside others with `trainer \
                 configs/compare.toml compare.methods={found},pinn`"
            ),
        ),
        _ => return error,
    };
    SettingsError::OtherKind { origin: origin.clone(), found: found.clone(), is, remedy }
}

impl From<SettingsError> for TrainerError {
    fn from(error: SettingsError) -> Self {
        Self::Settings(of_other_kind(error))
    }
}

impl From<SweepError> for SweepCommandError {
    fn from(error: SweepError) -> Self {
        Self::Plan(match error {
            SweepError::BadCombination { number, overrides, source } => {
                SweepError::BadCombination { number, overrides, source: of_other_kind(source) }
            }
            error => error,
        })
    }
}
