//! Split of records into training, validation and test parts.

use super::Trajectory;
use crate::LearnError;
use serde::{Deserialize, Serialize};

/// Kind of held-out data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SplitKind {
    /// Whole records: the last ones in the list.
    #[default]
    Record,
    /// The end of every record.
    Time,
    /// Whole records, of which only the end is scored: initial states and times that were not trained on.
    Both,
}

/// Options of a split.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Split {
    /// Kind of held-out data.
    pub kind: SplitKind,
    /// Number of test records, the last ones in the list; used if records are held out.
    pub test_records: usize,
    /// Number of validation records, those before the test records. With 0, the end of the training records
    /// validates.
    pub validation_records: usize,
    /// Share of a record's time, at its end, that is scored; used if ends are held out.
    pub test_share: f64,
    /// Share of a training part's time, at its end, that validates if no record does.
    pub validation_share: f64,
}

/// Training, validation and test parts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Parts {
    /// Stretches that models are fitted to.
    pub train: Vec<Trajectory>,
    /// Stretches that choose among models.
    pub validation: Vec<Trajectory>,
    /// Stretches that score models.
    pub test: Vec<Trajectory>,
}

/// Splits records; every part gets at least one trajectory.
pub(super) fn split(records: &[Trajectory], split: &Split) -> Result<Parts, LearnError> {
    let Some(first) = records.first() else { return Err(LearnError::NoRecords) };
    if split.kind == SplitKind::Time {
        let (train, test): (Vec<_>, Vec<_>) =
            records.iter().map(|record| at_share(record, split.test_share)).unzip();
        return with_validation(train, test, split);
    }
    if records.len() == 1 {
        return Err(LearnError::OneRecord { record: first.name().to_owned() });
    }
    if split.test_records == 0 {
        return Err(LearnError::NoTest);
    }
    let held = split.test_records + split.validation_records;
    let trained = records.len().checked_sub(held).filter(|&trained| trained > 0);
    let trained = trained.ok_or(LearnError::NoTraining {
        records: records.len(),
        test: split.test_records,
        validation: split.validation_records,
    })?;
    let (seen, test) = records.split_at(trained + split.validation_records);
    let test = match split.kind {
        SplitKind::Both => test.iter().map(|record| at_share(record, split.test_share).1).collect(),
        _ => test.to_vec(),
    };
    let (train, validation) = seen.split_at(trained);
    if validation.is_empty() {
        return with_validation(train.to_vec(), test, split);
    }
    Ok(Parts { train: train.to_vec(), validation: validation.to_vec(), test })
}

fn with_validation(
    train: Vec<Trajectory>,
    test: Vec<Trajectory>,
    split: &Split,
) -> Result<Parts, LearnError> {
    let (train, validation) = train.iter().map(|part| at_share(part, split.validation_share)).unzip();
    Ok(Parts { train, validation, test })
}

/// Splits a record in time: all but the last share, and that share.
fn at_share(record: &Trajectory, share: f64) -> (Trajectory, Trajectory) {
    let cut = record.samples_within((1.0 - share) * record.duration_s());
    (record.part(0, cut), record.part(cut, record.len()))
}
