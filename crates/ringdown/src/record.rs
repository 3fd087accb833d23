//! Records from files and from arrays.

use crate::error::Error;
use record::{
    Clock, ClockChoice, ColumnReading, Coordinate, Fault, Origin, Quantity, Source, Statements, Unit,
};
use std::path::Path;
use workflow::{Loaded, Reading, WorkflowError};

/// A record of one run of an oscillator: stamps, observed values and, for a driven system, the input.
///
/// Numbers are stored in SI units, stamps as written. The clock is chosen when the record is used
/// ([`ClockChoice`]).
#[derive(Debug, Clone)]
pub struct Record {
    pub(crate) loaded: Loaded,
}

/// Description of arrays for [`Record::new`]. By default the values are positions in radians, in free motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Arrays {
    /// Name of the record in messages and results.
    pub name: String,
    /// Unit of the values.
    pub unit: Unit,
    /// Observed quantity; `None` to derive it from the unit.
    pub quantity: Option<Quantity>,
    /// Input that drove the system, one number for each sample.
    pub input: Option<Vec<f64>>,
    /// Unit of the input; `None` to use the numbers as they are.
    pub input_unit: Option<Unit>,
    /// Choice of the clock.
    pub clock: ClockChoice,
    /// Origin of the numbers: measured or simulated.
    pub origin: Origin,
}

impl Default for Arrays {
    fn default() -> Self {
        Self {
            name: "arrays".to_owned(),
            unit: Unit::Radian,
            quantity: None,
            input: None,
            input_unit: None,
            clock: ClockChoice::Auto,
            origin: Origin::Unstated,
        }
    }
}

impl Arrays {
    /// Returns the observed quantity: as stated, else derived from the unit.
    #[must_use]
    pub fn observed_quantity(&self) -> Quantity {
        self.quantity.unwrap_or(match self.unit.si() {
            symbol if symbol.ends_with("/s^2") => Quantity::Acceleration,
            symbol if symbol.ends_with("/s") => Quantity::Velocity,
            _ => Quantity::Position,
        })
    }
}

impl Record {
    /// Creates a record from arrays: stamps in seconds, values in [`Arrays::unit`].
    ///
    /// # Errors
    /// [`Error::Record`] for fewer than 8 samples, arrays of different lengths, a number that is not finite,
    /// or a stamp smaller than its predecessor.
    ///
    /// ```
    /// use ringdown_lab::{Arrays, Record, Unit};
    ///
    /// let time_s: Vec<f64> = (0..500).map(|i| f64::from(i) / 100.0).collect();
    /// let degrees: Vec<f64> = time_s.iter().map(|t| 40.0 * (-0.2 * t).exp() * (9.0 * t).cos()).collect();
    /// let record = Record::new(time_s, degrees, Arrays { unit: Unit::Degree, ..Arrays::default() })?;
    /// assert_eq!(record.unit(), "rad");
    /// assert!((record.values()[0] - 40.0_f64.to_radians()).abs() < 1e-15);
    /// # Ok::<(), ringdown_lab::Error>(())
    /// ```
    pub fn new(stamps_s: Vec<f64>, values: Vec<f64>, arrays: Arrays) -> Result<Self, Error> {
        let quantity = arrays.observed_quantity();
        let Arrays { name, unit, input, input_unit, clock, origin, .. } = arrays;
        let bytes: Vec<u8> = [&stamps_s, &values]
            .into_iter()
            .chain(input.as_ref())
            .flatten()
            .flat_map(|number| number.to_le_bytes())
            .collect();
        let scaled = |column: Vec<f64>, unit: Unit| -> Vec<f64> {
            column.into_iter().map(|number| number * unit.to_si()).collect()
        };
        let column = |name: &str, unit: Option<Unit>| ColumnReading {
            column: name.to_owned(),
            unit: unit.map(|unit| unit.symbol().to_owned()),
            because: "given as an array".to_owned(),
        };
        let reading = record::Reading {
            sentence: format!("read as: arrays; values in {}", unit.symbol()),
            format: "arrays".to_owned(),
            time: Some(column("time", None)),
            value: column("values", Some(unit)),
            input: input.as_ref().map(|_| column("input", input_unit)),
            quantity,
            coordinate: if unit.si().starts_with("rad") {
                Coordinate::Angle
            } else {
                Coordinate::Displacement
            },
            ..record::Reading::default()
        };
        let input = match (input, input_unit) {
            (Some(input), Some(unit)) => Some(scaled(input, unit)),
            (input, _) => input,
        };
        let record = record::Record::new(stamps_s, scaled(values, unit), input, quantity, unit.si())
            .map_err(|fault| of_record(&name, fault))?;
        let source = Source {
            path: name,
            digest: runs::digest(&bytes),
            statements: Statements { origin: Some(origin), ..Statements::default() },
            findings: Vec::new(),
            reading,
        };
        let columns = if record.input().is_some() { "time, values, input" } else { "time, values" };
        let loaded = Loaded { record, source, clock, origin: None, columns: columns.to_owned() };
        Ok(Self { loaded })
    }

    /// Checks arrays as [`Record::new`] does, without taking or copying them; messages refer to the record as
    /// `name`.
    ///
    /// # Errors
    /// As [`Record::new`].
    pub fn check(name: &str, stamps_s: &[f64], values: &[f64], input: Option<&[f64]>) -> Result<(), Error> {
        record::Record::check(stamps_s, values, input).map_err(|fault| of_record(name, fault))
    }

    /// Reads a record file: CSV with any separator, units and dates in its header, or a host log.
    ///
    /// Settings that the options leave open are found from the file; [`Record::reading`] reports them.
    ///
    /// # Errors
    /// [`Error::Record`] with the line, what was expected and the option to set.
    pub fn read(path: impl AsRef<Path>, reading: &Reading) -> Result<Self, Error> {
        Ok(Self { loaded: Loaded::read(path.as_ref(), reading)? })
    }

    /// Reads a record from the bytes of a file; messages refer to it as `name`.
    ///
    /// # Errors
    /// As [`Record::read`].
    ///
    /// ```
    /// use ringdown_lab::{Reading, Record};
    ///
    /// let log = "timestamp_ms;Winkel [deg]\n0;10,0\n10;9,9\n20;9,6\n30;9,1\n40;8,4\n50;7,5\n60;6,5\n70;5,3\n";
    /// let record = Record::parse("log.csv", log.as_bytes(), &Reading::default())?;
    /// assert_eq!(record.len(), 8);
    /// assert!(record.reading().contains("decimal comma"));
    /// # Ok::<(), ringdown_lab::Error>(())
    /// ```
    pub fn parse(name: &str, bytes: &[u8], reading: &Reading) -> Result<Self, Error> {
        Ok(Self { loaded: Loaded::parse(name, bytes, reading)? })
    }

    /// Returns the number of samples, at least 8.
    #[must_use]
    pub fn len(&self) -> usize {
        self.loaded.record.len()
    }

    /// Returns `true` if there are no samples, which never happens.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.loaded.record.is_empty()
    }

    /// Returns the stamps as written, in seconds.
    #[must_use]
    pub fn stamps_s(&self) -> &[f64] {
        self.loaded.record.stamps_s()
    }

    /// Returns the observed values, in [`Record::unit`].
    #[must_use]
    pub fn values(&self) -> &[f64] {
        self.loaded.record.values()
    }

    /// Returns the input, if there is one.
    #[must_use]
    pub fn input(&self) -> Option<&[f64]> {
        self.loaded.record.input()
    }

    /// Returns the SI symbol of the values' unit, such as `rad`.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        self.loaded.record.unit()
    }

    /// Returns the observed quantity.
    #[must_use]
    pub fn quantity(&self) -> Quantity {
        self.loaded.record.quantity()
    }

    /// Returns the name of the record: its path, or the name in [`Arrays`].
    #[must_use]
    pub fn name(&self) -> &str {
        &self.loaded.source.path
    }

    /// Returns the interpretation of the file in one line.
    #[must_use]
    pub fn reading(&self) -> &str {
        &self.loaded.source.reading.sentence
    }

    /// Returns the believed clock: times in seconds, sampling rate, and the reason for the choice.
    ///
    /// # Errors
    /// [`Error::Record`] if no time passes between the stamps.
    pub fn clock(&self) -> Result<Clock, Error> {
        Ok(self.loaded.believed()?)
    }

    /// Returns the record as CSV text with `decimals` decimals of stamps and values, at most 12. Two comment
    /// lines at the top mark simulated records.
    #[must_use]
    pub fn to_csv(&self, decimals: u8) -> String {
        let decimals = decimals.min(simulator::MOST_DECIMALS);
        let text = simulator::csv_text(&self.loaded.record, decimals, decimals);
        if self.loaded.source.statements.origin == Some(Origin::Simulated) {
            return text;
        }
        // The first two lines mark a record as simulated.
        text.splitn(3, '\n').nth(2).unwrap_or_default().to_owned()
    }
}

pub(crate) fn of_record(name: &str, fault: Fault) -> Error {
    Error::Record(WorkflowError::Record(fault.in_file(name)))
}
