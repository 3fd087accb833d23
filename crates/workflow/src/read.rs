//! From files to what a diagnosis may see: no name and no path among it.

use crate::error::{WorkflowError, in_options};
use diagnosis::Observations;
use dynamics::Coordinate;
use dynamics::chain::Observed;
use experiment::StatedNominal;
use record::{Clock, ClockChoice, Fault, Origin, Quantity, ReadOptions, Record, Source, Statements, Unit};
use report::format::{quantity, significant};
use results::{DataSummary, RecordRow};
use std::path::Path;

/// Options for reading record files.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reading {
    /// Format, columns, units, quantity.
    pub options: ReadOptions,
    /// The clock to believe.
    pub clock: ClockChoice,
    /// Origin of the numbers, where the file does not state it.
    pub origin: Option<Origin>,
    /// Takes the means of the observed column and of the input away: for channels with an arbitrary zero.
    pub remove_mean: bool,
}

impl Reading {
    /// The same with the observed column named.
    #[must_use]
    pub fn value(mut self, column: &str) -> Self {
        self.options.columns.value = Some(column.to_owned());
        self
    }

    /// The same with the unit of the observed column.
    #[must_use]
    pub fn unit(mut self, unit: Unit) -> Self {
        self.options.columns.unit = Some(unit);
        self
    }

    /// The same with the time column named.
    #[must_use]
    pub fn time(mut self, column: &str) -> Self {
        self.options.columns.time = Some(column.to_owned());
        self
    }

    /// The same with the input's column named.
    #[must_use]
    pub fn input(mut self, column: &str) -> Self {
        self.options.columns.input = Some(column.to_owned());
        self
    }

    /// The same with the clock to believe.
    #[must_use]
    pub fn clock(mut self, clock: ClockChoice) -> Self {
        self.clock = clock;
        self
    }

    /// The same options for records of a system: columns and units as its coordinate asks for, and an input where it has
    /// a gain for one.
    #[must_use]
    pub fn for_nominal(mut self, stated: &StatedNominal) -> Self {
        self.options.coordinate = Some(match stated.nominal.coordinate() {
            Coordinate::Angle => record::Coordinate::Angle,
            Coordinate::Displacement => record::Coordinate::Displacement,
        });
        self.options.driven = stated.driven;
        self
    }
}

/// A record with its source and the clock to believe.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The record, in SI units.
    pub record: Record,
    /// Where it came from, for people.
    pub source: Source,
    /// The clock to believe.
    pub clock: ClockChoice,
    /// Origin of the numbers, where the file does not state it.
    pub origin: Option<Origin>,
    /// The columns that there are, as messages list them.
    pub columns: String,
}

/// A record as the diagnosis sees it, and what people are told of it.
#[derive(Debug, Clone)]
pub struct Given {
    /// All that the diagnosis sees.
    pub observations: Observations,
    /// The record's line in results.
    pub row: RecordRow,
    /// Observed quantity.
    pub quantity: Quantity,
    /// True where there is an input.
    pub driven: bool,
    /// Sampling rate of the believed clock, in hertz.
    pub rate_hz: f64,
}

impl Loaded {
    /// Reads a record by the options and, where these are silent, by its header.
    ///
    /// # Errors
    /// [`WorkflowError::Record`] with the line, what was expected and the option to set.
    pub fn read(path: &Path, reading: &Reading) -> Result<Self, WorkflowError> {
        let name = path.display().to_string();
        let fault = |fault: Fault| WorkflowError::Record(fault.in_file(&name));
        if path.is_dir() {
            return Err(fault(Fault::Folder));
        }
        let bytes =
            std::fs::read(path).map_err(|error| fault(Fault::Unreadable { problem: error.to_string() }))?;
        Self::parse(&name, &bytes, reading)
    }

    /// Reads a record from the bytes of a file; `name` is what messages call it.
    ///
    /// # Errors
    /// As [`Loaded::read`].
    pub fn parse(name: &str, bytes: &[u8], reading: &Reading) -> Result<Self, WorkflowError> {
        let (record, source) =
            record::read_text(name, bytes, &reading.options).map_err(WorkflowError::Record)?;
        let record = if reading.remove_mean {
            centered(&record).map_err(|fault| WorkflowError::Record(fault.in_file(name)))?
        } else {
            record
        };
        Ok(Self { record, source, clock: reading.clock, origin: reading.origin, columns: header(bytes) })
    }

    /// The clock that is believed.
    ///
    /// # Errors
    /// [`WorkflowError::Record`] where the stamps are no clock.
    pub fn believed(&self) -> Result<Clock, WorkflowError> {
        self.clock_of(self.clock)
    }

    fn clock_of(&self, choice: ClockChoice) -> Result<Clock, WorkflowError> {
        Clock::new(&self.record, choice)
            .map_err(|fault| WorkflowError::Record(fault.in_file(&self.source.path)))
    }

    /// The record as a diagnosis of a system sees it.
    ///
    /// # Errors
    /// [`WorkflowError::OtherUnit`] and [`WorkflowError::MissingInput`] for a record that cannot be of that system.
    pub fn given(&self, stated: &StatedNominal) -> Result<Given, WorkflowError> {
        let record = &self.record;
        check_unit(&self.source.path, record, stated.nominal.coordinate())?;
        if stated.driven && record.input().is_none() {
            let file = self.source.path.clone();
            return Err(WorkflowError::MissingInput { file, columns: self.columns.clone() });
        }
        let (clock, believed) = (self.believed()?, self.clock_of(ClockChoice::Auto)?);
        let stated = Statements { origin: self.origin, ..Statements::default() };
        let summary = DataSummary::new(record, &self.source, &clock, &believed, stated);
        let (first, last) = (clock.times_s.first(), clock.times_s.last());
        Ok(Given {
            observations: Observations::new(record, &clock),
            row: RecordRow {
                path: summary.path,
                digest: summary.digest,
                origin: summary.origin,
                samples: summary.samples,
                // A record of no sample lasts no time.
                duration_s: first.zip(last).map_or(0.0, |(first, last)| last - first),
                clock: summary.clock,
                clock_reason: summary.clock_reason,
                findings: summary
                    .findings
                    .iter()
                    .map(|finding| in_options(finding))
                    .chain(bias(record))
                    .collect(),
                reading: summary.reading,
            },
            quantity: record.quantity(),
            driven: record.input().is_some(),
            rate_hz: clock.sample_rate_hz,
        })
    }
}

/// The first line that is neither empty nor a comment.
fn header(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = text.trim_start_matches('\u{feff}').lines().map(str::trim);
    // A file of comments has no header.
    lines.find(|line| !line.is_empty() && !line.starts_with('#')).unwrap_or_default().to_owned()
}

/// The simulator's name for what moves in a record.
#[must_use]
pub fn coordinate_of(coordinate: record::Coordinate) -> Coordinate {
    match coordinate {
        record::Coordinate::Angle => Coordinate::Angle,
        record::Coordinate::Displacement => Coordinate::Displacement,
    }
}

/// Symbol of the unit that records of a coordinate are in.
fn usual_unit(coordinate: Coordinate, quantity: Quantity) -> &'static str {
    match (coordinate, quantity) {
        (Coordinate::Angle, Quantity::Position) => "rad",
        (Coordinate::Angle, Quantity::Velocity) => "rad/s",
        (Coordinate::Angle, Quantity::Acceleration) => "rad/s^2",
        (Coordinate::Displacement, Quantity::Position) => "m",
        (Coordinate::Displacement, Quantity::Velocity) => "m/s",
        (Coordinate::Displacement, Quantity::Acceleration) => "m/s^2",
    }
}

/// A record whose unit cannot be that of the nominal coordinate is of another system, or mislabeled. A voltage stands
/// for a displacement, whatever its derivative.
fn check_unit(file: &str, record: &Record, coordinate: Coordinate) -> Result<(), WorkflowError> {
    let expected = usual_unit(coordinate, record.quantity());
    let voltage = record.unit() == Unit::Volt.si() && coordinate == Coordinate::Displacement;
    if record.unit() == expected || voltage {
        return Ok(());
    }
    Err(WorkflowError::OtherUnit { file: file.to_owned(), found: record.unit(), expected })
}

/// The record with the means of the observed column and of the input taken away.
///
/// # Errors
/// As [`Record::new`], of numbers so large that their mean is not finite.
pub fn centered(record: &Record) -> Result<Record, Fault> {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let value = mean(record.values());
    // Without an input nothing is taken from it.
    let input = record.input().map_or(0.0, mean);
    record.mapped(|own| own - value, |own| own - input)
}

/// Part of half their range that values have to pass, to either side, for a half swing to count.
const HALF_SWING: f64 = 0.1;

/// A sentence where a velocity or an acceleration has a mean that no free swing has, as of a sensor's bias or of gravity; none
/// with an input, which may push to one side.
///
/// The mean of a rate is what the swing changes by over the time: 2A/T at most. Of n half swings of amplitude A it is at most 2/(πn)
/// of the rate's own amplitude.
#[must_use]
pub fn bias(record: &Record) -> Option<String> {
    if record.quantity() == Quantity::Position || record.input().is_some() {
        return None;
    }
    let values = record.values();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let half = 0.5 * (highest - lowest);
    let (mut swings, mut side) = (0, 0.0);
    for off in values.iter().map(|value| value - mean).filter(|off| off.abs() > HALF_SWING * half) {
        swings += usize::from(off.signum() != side);
        side = off.signum();
    }
    let most = 2.0 / (std::f64::consts::PI * swings.saturating_sub(1).max(1) as f64) * half;
    (mean.abs() > most).then(|| {
        let what = if record.quantity() == Quantity::Velocity { "velocity" } else { "acceleration" };
        format!(
            "the values average {}, which the {what} of a free swing does not: a sensor's bias, or gravity, for which an effect \
             would be named; subtract it with --remove-mean",
            quantity(&significant(mean, 3), record.unit())
        )
    })
}

/// The simulator's name for what the sensor observes.
pub(crate) fn observed(quantity: Quantity) -> Observed {
    match quantity {
        Quantity::Position => Observed::Position,
        Quantity::Velocity => Observed::Velocity,
        Quantity::Acceleration => Observed::Acceleration,
    }
}
