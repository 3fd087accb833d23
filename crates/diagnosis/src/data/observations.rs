//! Observations of one record, which are all that a diagnosis reads of it.

#![allow(clippy::indexing_slicing, reason = "`Record::new` checks that there are samples")]

use crate::noise::statistics::duration;
use record::{Clock, ClockKind, Quantity, Record, StampStatistics};

/// Observations of one record: times by the chosen clock, values and input. They hold neither a path nor an
/// origin.
#[derive(Debug, Clone, PartialEq)]
pub struct Observations {
    /// Time of each sample in seconds since the first, by the chosen clock.
    pub(crate) times_s: Vec<f64>,
    pub(crate) values: Vec<f64>,
    pub(crate) input: Option<Vec<f64>>,
    /// Times in seconds and inputs of the rows between the samples that hold an input but no value.
    pub(crate) input_rows: Vec<(f64, f64)>,
    pub(crate) quantity: Quantity,
    pub(crate) unit: &'static str,
    /// Time stamps as written, in seconds since the first.
    pub(crate) stamps_s: Vec<f64>,
    pub(crate) clock: ClockKind,
    pub(crate) sample_rate_hz: f64,
    /// Relative standard error of the clock's sampling rate; 0 if the clock uses the stamps as they are.
    pub(crate) rate_error: f64,
    pub(crate) stamps: StampStatistics,
    /// Step of the sensor, if the values lie on a lattice.
    pub(crate) resolution: Option<f64>,
    /// Spectral density of the noise of the drive, two-sided, in (N m)² s or N² s; 0 if the drive is exact.
    pub(crate) drive_noise: f64,
    /// Indices of the samples that come after a gap in the rows.
    pub(crate) after_gaps: Vec<usize>,
}

/// Number of usual steps in rows that a gap exceeds. After one or two missing rows the neighboring samples
/// are close enough.
const STEPS: usize = 3;

/// Returns the indices of the samples that come after a gap in the rows. Rows that hold only an input fill a
/// gap.
fn after_gaps(record: &Record) -> Vec<usize> {
    let Some(rows) = record.rows() else { return Vec::new() };
    let steps: Vec<usize> = rows.windows(2).filter_map(|w| Some(w.last()? - w.first()?)).collect();
    let mut ordered = steps.clone();
    ordered.sort_unstable();
    // A single row has no step to its neighbor.
    let usual = ordered.get(ordered.len() / 2).copied().unwrap_or(1);
    let mut known = [rows, &record.input_rows().iter().map(|own| own.row).collect::<Vec<_>>()].concat();
    known.sort_unstable();
    let gaps = known.windows(2).filter_map(|w| Some((w.first()?, w.last()?)));
    let gaps = gaps.filter(|(from, to)| **to - **from > STEPS * usual);
    let mut after: Vec<usize> = gaps.map(|(_, to)| rows.partition_point(|row| row < to)).collect();
    after.dedup();
    after
}

impl Observations {
    /// Creates the observations of a record, with times by the given clock.
    #[must_use]
    pub fn new(record: &Record, clock: &Clock) -> Self {
        let (first, stamp) = (clock.start_s(), record.stamps_s()[0]);
        Self {
            times_s: clock.times_s.iter().map(|time| time - first).collect(),
            values: record.values().to_vec(),
            input: record.input().map(<[f64]>::to_vec),
            input_rows: clock
                .inputs_between(record)
                .into_iter()
                .map(|(time, input)| (time - first, input))
                .collect(),
            quantity: record.quantity(),
            unit: record.unit(),
            stamps_s: record.stamps_s().iter().map(|time| time - stamp).collect(),
            clock: clock.kind,
            sample_rate_hz: clock.sample_rate_hz,
            rate_error: match clock.kind {
                ClockKind::Host => 0.0,
                _ => clock.sample_rate_std_error_hz / clock.sample_rate_hz,
            },
            stamps: clock.statistics.clone(),
            resolution: record.lattice().map(|lattice| lattice.step),
            drive_noise: 0.0,
            after_gaps: after_gaps(record),
        }
    }

    /// Sets the spectral density of white noise in the drive, two-sided, in (N m)² s or N² s: what a measured torque
    /// and a motion computed from measurements are off. It moves the system, so that fits leave it as a colored
    /// residual. A value that is not positive and finite counts as 0.
    #[must_use]
    pub fn with_drive_noise(self, density: f64) -> Self {
        Self { drive_noise: if density.is_finite() { density.max(0.0) } else { 0.0 }, ..self }
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Returns `true` if there are no samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Returns the time of each sample in seconds since the first, by the chosen clock.
    #[must_use]
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// Returns the observed values in SI units.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the input at each sample; `None` if the record has none.
    #[must_use]
    pub fn input(&self) -> Option<&[f64]> {
        self.input.as_deref()
    }

    /// Returns the time from the first sample to the last, in seconds.
    pub(crate) fn duration_s(&self) -> f64 {
        duration(&self.times_s)
    }

    /// Returns the step of the readings; 0 if they lie on no lattice.
    pub(crate) fn step(&self) -> f64 {
        self.resolution.unwrap_or(0.0)
    }
}
