//! How a file was read: kept in every result, and enough to read it the same way again.

use crate::columns::Missing;
use crate::record::Quantity;
use crate::unit::TimeUnit;
use crate::words::counted;
use serde::{Deserialize, Serialize};

/// What moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Coordinate {
    /// An angle.
    #[default]
    Angle,
    /// A displacement, or a voltage that stands for one.
    Displacement,
}

/// A column as it was read.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ColumnReading {
    /// Its title.
    pub column: String,
    /// The unit that its numbers were taken to be in, as options write it; none where it is not known.
    pub unit: Option<String>,
    /// Why this column and this unit: a phrase.
    pub because: String,
}

/// How a file was read.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Reading {
    /// All of it in one line: `read as: …`.
    pub sentence: String,
    /// `csv` or `host-log`.
    pub format: String,
    /// Sign between columns: `comma`, `semicolon`, `tab` or `blank`.
    pub separator: String,
    /// Decimal sign: `point` or `comma`.
    pub decimal: String,
    /// Line of the header, from 1.
    pub header_line: u64,
    /// The time column; none where samples are laid out at a rate.
    pub time: Option<ColumnReading>,
    /// The rate at which they are, in hertz.
    pub sample_rate_hz: Option<f64>,
    /// The observed column.
    pub value: ColumnReading,
    /// The input's column.
    pub input: Option<ColumnReading>,
    /// The lines that were chosen: `COLUMN=VALUE`.
    #[serde(rename = "where")]
    pub filter: Option<String>,
    /// Cells without a number in the columns that were read.
    pub missing_cells: usize,
    /// Lines that were left out for these.
    pub missing_lines: usize,
    /// What was done with them.
    pub missing: Missing,
    /// What the sensor observes.
    pub quantity: Quantity,
    /// What moves.
    pub coordinate: Coordinate,
}

impl Reading {
    /// The options that read the file in the same way, as keys of the configuration's section `data` with their values.
    /// On the command line `time_unit` is `--time-unit`, and `sample_rate_hz` is `--sample-rate`.
    #[must_use]
    pub fn options(&self) -> Vec<(&'static str, String)> {
        let mut options = vec![("format", self.format.clone())];
        // A host log has its own columns.
        if self.format != "host-log" {
            let mut column = |read: Option<&ColumnReading>, [name, unit]: [&'static str; 2]| {
                options.extend(read.map(|read| (name, read.column.clone())));
                options.extend(read.and_then(|read| read.unit.clone()).map(|symbol| (unit, symbol)));
            };
            column(self.time.as_ref(), ["time", "time_unit"]);
            column(Some(&self.value), ["value", "unit"]);
            column(self.input.as_ref(), ["input", "input_unit"]);
            options.extend(self.sample_rate_hz.map(|rate| ("sample_rate_hz", rate.to_string())));
            options.extend(self.filter.clone().map(|filter| ("where", filter)));
            if self.missing_cells > 0 {
                options.push(("missing", self.missing.name().to_owned()));
            }
        }
        options.push(("quantity", self.quantity.name().to_owned()));
        options
    }

    /// The same with its sentence.
    pub(crate) fn worded(self, rate_hz: f64) -> Self {
        let column = |role: &str, read: &ColumnReading| match &read.unit {
            Some(unit) if unit == TimeUnit::Iso.name() => {
                format!("{role} = \"{}\", dates or times of the day", read.column)
            }
            Some(unit) if read.because.contains("unit assumed") => {
                format!("{role} = \"{}\" in {unit} (assumed)", read.column)
            }
            Some(unit) => format!("{role} = \"{}\" in {unit}", read.column),
            None => format!("{role} = \"{}\" as it is", read.column),
        };
        let mut first = match self.format.as_str() {
            "host-log" => "a host log".to_owned(),
            _ => format!("{}-separated", self.separator),
        };
        if self.decimal == "comma" {
            first.push_str(", decimal comma");
        }
        let mut parts = vec![first];
        parts.extend(self.filter.as_ref().map(|filter| format!("lines with {filter}")));
        parts.push(match (&self.time, self.sample_rate_hz) {
            (Some(time), _) => column("time", time),
            (None, Some(rate)) => format!("no time column, laid out at {rate} Hz"),
            (None, None) => "no time column".to_owned(),
        });
        parts.push(column("value", &self.value));
        parts.push(self.input.as_ref().map_or_else(|| "no input".to_owned(), |input| column("input", input)));
        parts.extend(self.missing_in_words());
        parts.push(format!("rate {rate_hz:.1} Hz"));
        Self { sentence: format!("read as: {}", parts.join("; ")), ..self }
    }

    /// How many cells were missing, and what was done about them; `None` where none was.
    #[must_use]
    pub fn missing_in_words(&self) -> Option<String> {
        let done = match self.missing {
            Missing::Drop => "dropped",
            _ => "left as gaps",
        };
        (self.missing_cells > 0).then(|| format!("{} {done}", counted(self.missing_cells, "missing cell")))
    }
}
