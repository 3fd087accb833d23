//! The record: samples of one coordinate with their stamps.

#![allow(clippy::indexing_slicing, reason = "the columns are as long as the stamps")]

use crate::FEWEST_SAMPLES;
use crate::error::Fault;
use crate::lattice::Lattice;
use crate::statistics::noise_level;
use serde::{Deserialize, Serialize};

/// Observed quantity: what the sensor reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Quantity {
    /// Angle or displacement itself.
    #[default]
    Position,
    /// First derivative, from a gyroscope or a laser vibrometer.
    Velocity,
    /// Second derivative, from an accelerometer.
    Acceleration,
}

impl Quantity {
    /// Returns the name used in configurations and results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
        }
    }
}

/// A record in SI units, with the stamps as written.
///
/// Invariants, checked on construction: at least [`FEWEST_SAMPLES`] samples; every number finite; stamps
/// never decreasing (equal ones are kept, because they show how the logger worked); one value and, if there
/// is an input, one input for each stamp.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    stamps_s: Vec<f64>,
    values: Vec<f64>,
    input: Option<Vec<f64>>,
    quantity: Quantity,
    unit: &'static str,
    /// Number of each sample among the rows of its file; `None` if every row holds a sample.
    rows: Option<Vec<usize>>,
    /// Inputs at rows between the samples that hold an input but no value.
    input_rows: Vec<InputRow>,
}

/// Input at a row of a file that holds no value: the sensor reading is missing, but the input still acted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputRow {
    /// Number of the row.
    pub row: usize,
    /// Stamp of the row as written, in seconds.
    pub stamp_s: f64,
    /// Input, in its own unit.
    pub input: f64,
}

/// Returns the row numbers and times of the last sample at or before a row and of the first sample after it;
/// `None` outside the samples.
pub(crate) fn beside(rows: &[usize], times: &[f64], row: usize) -> Option<[(usize, f64); 2]> {
    let after = rows.partition_point(|number| *number <= row);
    let at = |sample: usize| Some((*rows.get(sample)?, *times.get(sample)?));
    Some([at(after.checked_sub(1)?)?, at(after)?])
}

/// Deviation from rest, in standard deviations of the noise, from which something moves.
const AT_REST: f64 = 6.0;

impl Record {
    /// Creates a record from columns in SI units.
    ///
    /// `stamps_s` are in seconds, `values` in `unit`, the SI symbol of the observed quantity, and `input`, if
    /// there is one, in N·m, N or its own unit.
    ///
    /// # Errors
    /// The first [`Fault`] found: too few samples, columns of different lengths, a number that is not finite,
    /// or a stamp smaller than its predecessor. Lines are counted from 1, as in a file without a header.
    pub fn new(
        stamps_s: Vec<f64>,
        values: Vec<f64>,
        input: Option<Vec<f64>>,
        quantity: Quantity,
        unit: &'static str,
    ) -> Result<Self, Fault> {
        Self::check(&stamps_s, &values, input.as_deref())?;
        Ok(Self { stamps_s, values, input, quantity, unit, rows: None, input_rows: Vec::new() })
    }

    /// Checks columns as [`Record::new`] does, without taking ownership.
    ///
    /// # Errors
    /// As [`Record::new`].
    pub fn check(stamps_s: &[f64], values: &[f64], input: Option<&[f64]>) -> Result<(), Fault> {
        if stamps_s.len() < FEWEST_SAMPLES {
            return Err(Fault::TooFewSamples { found: stamps_s.len(), needed: FEWEST_SAMPLES });
        }
        for (what, column) in [("values", Some(values)), ("input", input)]
            .into_iter()
            .filter_map(|(what, column)| column.map(|column| (what, column)))
        {
            if column.len() != stamps_s.len() {
                return Err(Fault::UnequalColumns {
                    column: what,
                    found: column.len(),
                    stamps: stamps_s.len(),
                });
            }
            if let Some(at) = column.iter().position(|number| !number.is_finite()) {
                return Err(Fault::NotFinite { line: at as u64 + 1, column: what.to_owned() });
            }
        }
        if let Some(at) = stamps_s.iter().position(|stamp| !stamp.is_finite()) {
            return Err(Fault::NotFinite { line: at as u64 + 1, column: "time".to_owned() });
        }
        let backward = stamps_s.iter().zip(stamps_s.iter().skip(1)).enumerate();
        for (at, (&previous, &stamp)) in backward {
            if stamp < previous {
                return Err(Fault::TimeDecreases { line: at as u64 + 2, previous, stamp });
            }
        }
        Ok(())
    }

    /// Returns the record with the row numbers of its samples, for a file in which other rows hold no value.
    /// Samples in rows that are not adjacent are not neighbors. The row numbers are ignored unless there is
    /// one for each sample and they increase.
    #[must_use]
    pub fn with_rows(self, rows: Vec<usize>) -> Self {
        let increase = rows.iter().zip(rows.iter().skip(1)).all(|(one, next)| one < next);
        let usable = rows.len() == self.len() && increase;
        Self { rows: usable.then_some(rows), ..self }
    }

    /// Returns the number of samples at the beginning in which nothing moves: those before two in a row that differ from
    /// the mean of all before by more than six times the noise or steps of the sensor. 0 if they are more than half of
    /// the record.
    #[must_use]
    pub fn samples_at_rest(&self) -> usize {
        let values = self.values();
        let far = AT_REST * noise_level(values).max(self.quantum());
        let mut sum = 0.0;
        let mut beyond = 0;
        let moved = values.iter().enumerate().position(|(at, value)| {
            // The first sample is its own mean.
            let mean = if at > 0 { sum / at as f64 } else { *value };
            sum += value;
            beyond = if (value - mean).abs() > far { beyond + 1 } else { 0 };
            beyond == 2
        });
        // A record without motion begins with its first sample.
        moved.map(|at| at - 1).filter(|held| 2 * held < values.len()).unwrap_or(0)
    }

    /// Returns the record with other values, as many.
    pub(crate) fn with_values(self, values: Vec<f64>) -> Self {
        debug_assert_eq!(values.len(), self.len(), "a value for every stamp");
        Self { values, ..self }
    }

    /// Returns the record with the inputs at rows that hold an input but no value. Only rows that lie between
    /// samples, by number ([`Record::with_rows`]) and by stamp, are kept.
    #[must_use]
    pub fn with_input_rows(self, rows: Vec<InputRow>) -> Self {
        // Without row numbers, or without an input, no row lies between samples.
        let numbers = self.rows.as_deref().filter(|_| self.input.is_some()).unwrap_or(&[]);
        let is_between = |row: &InputRow| {
            let ends = beside(numbers, &self.stamps_s, row.row);
            ends.is_some_and(|[(_, from), (_, to)]| (from..=to).contains(&row.stamp_s))
        };
        let mut input_rows: Vec<InputRow> =
            rows.into_iter().filter(|row| row.input.is_finite() && is_between(row)).collect();
        input_rows
            .sort_by(|one, other| (one.row.cmp(&other.row)).then(one.stamp_s.total_cmp(&other.stamp_s)));
        input_rows.dedup_by(|later, one| later.row == one.row && later.stamp_s <= one.stamp_s);
        Self { input_rows, ..self }
    }

    /// Returns the inputs at rows between the samples that hold an input but no value, in the order of the
    /// rows; empty if there are none.
    #[must_use]
    pub fn input_rows(&self) -> &[InputRow] {
        &self.input_rows
    }

    /// Returns the record with functions applied to its values and to its inputs, including those between
    /// samples.
    ///
    /// # Errors
    /// As [`Record::new`].
    pub fn mapped(&self, value: impl Fn(f64) -> f64, input: impl Fn(f64) -> f64) -> Result<Self, Fault> {
        let values = self.values.iter().copied().map(value).collect();
        let own = self.input.as_ref().map(|own| own.iter().copied().map(&input).collect());
        let mapped = Self::new(self.stamps_s.clone(), values, own, self.quantity, self.unit)?;
        let input_rows = self.input_rows.iter().map(|row| InputRow { input: input(row.input), ..*row });
        Ok(Self { rows: self.rows.clone(), input_rows: input_rows.collect(), ..mapped })
    }

    /// Returns the part of the record between two stamps, in seconds, both included, with its ends; the whole
    /// record and `None` without either.
    ///
    /// # Errors
    /// [`Fault::EmptyPart`] if fewer than [`FEWEST_SAMPLES`] samples lie between them.
    pub fn between(self, from_s: Option<f64>, to_s: Option<f64>) -> Result<(Self, Option<[f64; 2]>), Fault> {
        let ends = self.stamps_s.first().copied().zip(self.stamps_s.last().copied());
        let Some((first_s, last_s)) = ends.filter(|_| from_s.or(to_s).is_some()) else {
            return Ok((self, None));
        };
        let (from_s, to_s) = (from_s.unwrap_or(first_s), to_s.unwrap_or(last_s));
        let from = self.stamps_s.partition_point(|stamp| *stamp < from_s);
        let to = self.stamps_s.partition_point(|stamp| *stamp <= to_s).max(from);
        if to - from < FEWEST_SAMPLES {
            let found = to - from;
            return Err(Fault::EmptyPart { from_s, to_s, found, needed: FEWEST_SAMPLES, first_s, last_s });
        }
        let cut = |column: &[f64]| column[from..to].to_vec();
        let rows = self.rows.as_deref().and_then(|rows| rows.get(from..to)).map(<[usize]>::to_vec);
        let part = Self {
            stamps_s: cut(&self.stamps_s),
            values: cut(&self.values),
            input: self.input.as_deref().map(cut),
            rows,
            input_rows: Vec::new(),
            ..self
        };
        Ok((part.with_input_rows(self.input_rows), Some([from_s, to_s])))
    }

    /// Returns the number of each sample among the rows of its file, or `None` if every row holds a sample.
    #[must_use]
    pub fn rows(&self) -> Option<&[usize]> {
        self.rows.as_deref()
    }

    /// Returns the number of rows without a value between the first and the last sample.
    #[must_use]
    pub fn empty_rows(&self) -> usize {
        match self.rows() {
            Some([first, .., last]) => last - first + 1 - self.len(),
            _ => 0,
        }
    }

    /// Returns the number of each sample: that of its row, or its index if every row holds a sample.
    pub(crate) fn row_numbers(&self) -> Vec<f64> {
        match &self.rows {
            Some(rows) => rows.iter().map(|row| *row as f64).collect(),
            None => (0..self.len()).map(|index| index as f64).collect(),
        }
    }

    /// Returns the number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.stamps_s.len()
    }

    /// Returns `true` if there are no samples, which the invariants exclude.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.stamps_s.is_empty()
    }

    /// Returns the stamps as written, in seconds, never decreasing.
    #[must_use]
    pub fn stamps_s(&self) -> &[f64] {
        &self.stamps_s
    }

    /// Returns the observed values, in [`Record::unit`].
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the measured input in its own unit, if there is one.
    #[must_use]
    pub fn input(&self) -> Option<&[f64]> {
        self.input.as_deref()
    }

    /// Returns the observed quantity.
    #[must_use]
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// Returns the SI symbol of the observed values, such as `rad`.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        self.unit
    }

    /// Returns the step that the values are rounded to, in their unit; 0 if they lie on no lattice.
    #[must_use]
    pub fn quantum(&self) -> f64 {
        self.lattice().map_or(0.0, |lattice| lattice.step)
    }

    /// Returns the lattice of the sensor's steps, if the values lie on one.
    #[must_use]
    pub fn lattice(&self) -> Option<Lattice> {
        Lattice::find(&self.values)
    }
}
