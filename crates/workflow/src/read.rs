//! Conversion of record files into observations, which are all that a diagnosis sees: no name and no path is
//! among them.

use crate::error::{WorkflowError, in_options};
use diagnosis::Observations;
use dynamics::Coordinate;
use dynamics::chain::Observed;
use experiment::StatedNominal;
use record::{
    Clock, ClockChoice, Fault, Origin, Quantity, ReadOptions, Record, Source, Statements, Unit, extremes,
};
use report::format::{quantity, significant};
use results::{DataSummary, ModeRow, RecordRow};

use crate::modes::modes;
use std::path::Path;

/// Options for reading record files.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reading {
    /// Format, columns, units, quantity.
    pub options: ReadOptions,
    /// Clock to believe.
    pub clock: ClockChoice,
    /// Origin of the numbers, if the file does not state it.
    pub origin: Option<Origin>,
    /// `true` to subtract the means of the observed column and of the input, for channels with an arbitrary
    /// zero.
    pub remove_mean: bool,
}

impl Reading {
    /// Sets the name of the observed column.
    #[must_use]
    pub fn value(mut self, column: &str) -> Self {
        self.options.columns.value = Some(column.to_owned());
        self
    }

    /// Sets the unit of the observed column.
    #[must_use]
    pub fn unit(mut self, unit: Unit) -> Self {
        self.options.columns.unit = Some(unit);
        self
    }

    /// Sets the name of the time column.
    #[must_use]
    pub fn time(mut self, column: &str) -> Self {
        self.options.columns.time = Some(column.to_owned());
        self
    }

    /// Sets the name of the input's column.
    #[must_use]
    pub fn input(mut self, column: &str) -> Self {
        self.options.columns.input = Some(column.to_owned());
        self
    }

    /// Sets the clock to believe.
    #[must_use]
    pub fn clock(mut self, clock: ClockChoice) -> Self {
        self.clock = clock;
        self
    }

    /// Adapts the options to records of a system: columns and units follow from its coordinate, and an input
    /// is expected if the system has an input gain.
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

/// Record with its source and the clock to believe.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// Record, in SI units.
    pub record: Record,
    /// Source of the record, for display only.
    pub source: Source,
    /// Clock to believe.
    pub clock: ClockChoice,
    /// Origin of the numbers, if the file does not state it.
    pub origin: Option<Origin>,
    /// Columns of the file, as messages list them.
    pub columns: String,
}

/// Record as the diagnosis sees it, with the details that are shown to users.
#[derive(Debug, Clone)]
pub struct Given {
    /// Observations, which are all that the diagnosis sees.
    pub observations: Observations,
    /// Row of the record in results.
    pub row: RecordRow,
    /// Modes of the record; empty if it shows only one.
    pub modes: Vec<ModeRow>,
    /// Observed quantity.
    pub quantity: Quantity,
    /// `true` if there is an input.
    pub driven: bool,
    /// Sampling rate of the believed clock, in hertz.
    pub rate_hz: f64,
}

impl Loaded {
    /// Reads a record according to the options; the header decides what the options leave open.
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

    /// Reads a record from the bytes of a file; `name` is its name in messages.
    ///
    /// # Errors
    /// Same as [`Loaded::read`].
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

    /// Returns the believed clock.
    ///
    /// # Errors
    /// [`WorkflowError::Record`] if the time stamps do not form a clock.
    pub fn believed(&self) -> Result<Clock, WorkflowError> {
        self.clock_of(self.clock)
    }

    fn clock_of(&self, choice: ClockChoice) -> Result<Clock, WorkflowError> {
        Clock::new(&self.record, choice)
            .map_err(|fault| WorkflowError::Record(fault.in_file(&self.source.path)))
    }

    /// Returns the record as a diagnosis of a system sees it.
    ///
    /// # Errors
    /// [`WorkflowError::OtherUnit`] and [`WorkflowError::MissingInput`] for a record that cannot belong to
    /// that system.
    pub fn given(&self, stated: &StatedNominal) -> Result<Given, WorkflowError> {
        let record = &self.record;
        check_unit(&self.source.path, record, stated.nominal.coordinate())?;
        if stated.driven && record.input().is_none() {
            let file = self.source.path.clone();
            return Err(WorkflowError::MissingInput { file, columns: self.columns.clone() });
        }
        self.check_turns()?;
        let (clock, believed) = (self.believed()?, self.clock_of(ClockChoice::Auto)?);
        let stated = Statements { origin: self.origin, ..Statements::default() };
        let summary = DataSummary::new(record, &self.source, &clock, &believed, stated);
        Ok(Given {
            observations: Observations::new(record, &clock),
            row: RecordRow {
                path: summary.path,
                digest: summary.digest,
                origin: summary.origin,
                samples: summary.samples,
                duration_s: clock.duration_s(),
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
            modes: modes(record, &clock),
            quantity: record.quantity(),
            driven: record.input().is_some(),
            rate_hz: clock.sample_rate_hz,
        })
    }
}

impl Loaded {
    /// Checks that angles in radians, if only the header says so, stay within one turn.
    fn check_turns(&self) -> Result<(), WorkflowError> {
        let read = &self.source.reading.value;
        let by_header = read.unit.as_deref() == Some(Unit::Radian.symbol()) && read.is_stated_by_header();
        let [lowest, highest] = extremes(self.record.values());
        let largest = 0.5 * (highest - lowest);
        if by_header && largest > std::f64::consts::TAU {
            return Err(WorkflowError::LooksLikeDegrees { file: self.source.path.clone(), largest });
        }
        Ok(())
    }
}

/// Returns the first line that is neither empty nor a comment.
fn header(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = text.trim_start_matches('\u{feff}').lines().map(str::trim);
    lines.find(|line| !line.is_empty() && !line.starts_with('#')).unwrap_or("").to_owned()
}

/// Converts a record's coordinate into the simulator's.
#[must_use]
pub fn coordinate_of(coordinate: record::Coordinate) -> Coordinate {
    match coordinate {
        record::Coordinate::Angle => Coordinate::Angle,
        record::Coordinate::Displacement => Coordinate::Displacement,
    }
}

/// Returns the symbol of the unit that records of a coordinate have.
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

/// Checks that a record's unit fits the nominal coordinate; otherwise the record belongs to another system or
/// is mislabeled. A voltage is accepted for a displacement and its derivatives.
fn check_unit(file: &str, record: &Record, coordinate: Coordinate) -> Result<(), WorkflowError> {
    let expected = usual_unit(coordinate, record.quantity());
    let is_signal = Unit::parse(record.unit()).is_some_and(Unit::is_signal);
    if record.unit() == expected || is_signal && coordinate == Coordinate::Displacement {
        return Ok(());
    }
    Err(WorkflowError::OtherUnit { file: file.to_owned(), found: record.unit(), expected })
}

/// Subtracts the means of the observed column and of the input, weighted by a Hann window: of swings that a record's
/// ends cut off, the plain mean keeps a part.
///
/// # Errors
/// Same as [`Record::new`], for numbers so large that their mean is not finite.
pub fn centered(record: &Record) -> Result<Record, Fault> {
    let turn = std::f64::consts::TAU / record.len() as f64;
    let mean = |values: &[f64]| {
        let weighted = values.iter().enumerate().map(|(at, value)| {
            let weight = 1.0 - libm::cos(turn * (at as f64 + 0.5));
            weight * value
        });
        // The weights' own mean is 1.
        weighted.sum::<f64>() / values.len() as f64
    };
    let value = mean(record.values());
    let input = record.input().map_or(0.0, mean);
    record.mapped(|own| own - value, |own| own - input)
}

/// Share of half their range that values have to exceed, on either side, for a half swing to count.
const HALF_SWING: f64 = 0.1;

/// Relative distance of a mean acceleration from gravity up to which the axis lies along it.
const ALONG_GRAVITY: f64 = 0.15;

/// Returns a warning if a velocity or an acceleration has a mean that no free swing has, as from a sensor's
/// bias or gravity. Returns `None` for velocities with an input, which may push to one side; an acceleration averages
/// about zero all the same.
///
/// The mean of a rate is the change of the swing over the time T, divided by T: at most 2A/T. For n half
/// swings of amplitude A it is at most 2/(πn) of the rate's own amplitude.
#[must_use]
pub fn bias(record: &Record) -> Option<String> {
    let is_pushed = record.quantity() == Quantity::Velocity && record.input().is_some();
    if record.quantity() == Quantity::Position || is_pushed {
        return None;
    }
    let values = record.values();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let [lowest, highest] = extremes(values);
    let half = 0.5 * (highest - lowest);
    let (mut swings, mut side) = (0, 0.0);
    for off in values.iter().map(|value| value - mean).filter(|off| off.abs() > HALF_SWING * half) {
        swings += usize::from(off.signum() != side);
        side = off.signum();
    }
    let most = 2.0 / (std::f64::consts::PI * swings.saturating_sub(1).max(1) as f64) * half;
    (mean.abs() > most).then(|| {
        let what = if record.quantity() == Quantity::Velocity { "velocity" } else { "acceleration" };
        let is_along_gravity = record.unit() == Unit::MeterPerSecondSquared.si()
            && (mean.abs() / Unit::StandardGravity.to_si() - 1.0).abs() < ALONG_GRAVITY;
        let doubled = if is_along_gravity {
            ". A sensor on a pendulum sees along gravity twice the frequency of the swing: compare the other axes with --value"
        } else {
            ""
        };
        format!(
            "the values average {}, but the {what} of what swings averages about zero: the sensor has a \
             bias or measures gravity, and a diagnosis would name an effect for it; subtract it with \
             --remove-mean{doubled}",
            quantity(&significant(mean, 3), record.unit())
        )
    })
}

/// Converts an observed quantity into the simulator's.
pub(crate) fn observed(quantity: Quantity) -> Observed {
    match quantity {
        Quantity::Position => Observed::Position,
        Quantity::Velocity => Observed::Velocity,
        Quantity::Acceleration => Observed::Acceleration,
    }
}
