//! What a diagnosis sees of a record.

use record::{Clock, ClockKind, Quantity, Record, StampStatistics};

/// The observations of one record: times by a believed clock, values, input. Neither a path nor an origin.
#[derive(Debug, Clone, PartialEq)]
pub struct Observations {
    /// Time of each sample in seconds since the first, by the believed clock.
    pub(crate) times_s: Vec<f64>,
    pub(crate) values: Vec<f64>,
    pub(crate) input: Option<Vec<f64>>,
    /// Times and inputs of rows between the samples that hold an input and no value.
    pub(crate) input_rows: Vec<(f64, f64)>,
    pub(crate) quantity: Quantity,
    pub(crate) unit: &'static str,
    /// Stamps as written, in seconds since the first.
    pub(crate) stamps_s: Vec<f64>,
    pub(crate) clock: ClockKind,
    pub(crate) sample_rate_hz: f64,
    /// Standard error of the rate that the clock was given, relative to it; 0 where the stamps are believed.
    pub(crate) rate_error: f64,
    pub(crate) stamps: StampStatistics,
    /// The sensor's step, where the values lie on a lattice.
    pub(crate) resolution: Option<f64>,
    /// Samples that come after rows without a value.
    pub(crate) after_gaps: Vec<usize>,
}

/// Usual steps in rows that a gap is longer than: a row or two leave the samples beside them near enough.
const STEPS: usize = 3;

/// Samples that come after a gap in the rows; where an input acts, after one in which it is not known.
fn after_gaps(record: &Record) -> Vec<usize> {
    // A record that was not read from a file has no rows, and no gaps in them.
    let rows = record.rows().unwrap_or_default();
    let steps: Vec<usize> = rows.windows(2).filter_map(|w| Some(w.last()? - w.first()?)).collect();
    let mut ordered = steps.clone();
    ordered.sort_unstable();
    // Without rows there is no step.
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
    /// Takes from a record what a diagnosis may see, on the clock that is believed.
    #[must_use]
    pub fn new(record: &Record, clock: &Clock) -> Self {
        // A clock has a time for every sample, and a record has samples.
        let first = clock.times_s.first().copied().unwrap_or_default();
        // As many stamps as times.
        let stamp = record.stamps_s().first().copied().unwrap_or_default();
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
            after_gaps: after_gaps(record),
        }
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether there are no samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Time of each sample in seconds since the first, by the believed clock.
    #[must_use]
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// What was observed, in SI units.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The input, where there is one.
    #[must_use]
    pub fn input(&self) -> Option<&[f64]> {
        self.input.as_deref()
    }

    pub(crate) fn duration_s(&self) -> f64 {
        // Without samples it lasts no time.
        self.times_s.last().copied().unwrap_or_default()
    }
}
