//! Interpretation of a file: part of every result, and sufficient to read the file in the same way again.

use crate::columns::Missing;
use crate::record::Quantity;
use crate::record::Record;
use crate::unit::TimeUnit;
use crate::words::counted;
use serde::{Deserialize, Serialize};

/// Coordinate of the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Coordinate {
    /// An angle.
    #[default]
    Angle,
    /// A displacement, or a voltage that stands for one.
    Displacement,
}

/// Interpretation of one column.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ColumnReading {
    /// Title of the column.
    pub column: String,
    /// Unit of the column's numbers, as options write it; `None` if it is not known.
    pub unit: Option<String>,
    /// Reason for the choice of this column and unit, as a phrase.
    pub because: String,
}

/// Separator of a file with a single column.
pub(crate) const NO_SEPARATOR: &str = "none";

impl ColumnReading {
    /// Returns `true` if the unit is that of the header.
    #[must_use]
    pub fn is_stated_by_header(&self) -> bool {
        self.because.ends_with("unit from the header")
    }
}

/// A record of which only a part was read, for people to look at.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Whole {
    /// Stamps between which it swings freely, in seconds; empty if the part was stated.
    pub free_s: Vec<[f64; 2]>,
    /// Stamps in seconds and values in SI units: the lowest and the highest of each of a few hundred stretches.
    pub outline: Vec<[f64; 2]>,
}

/// Number of stretches of an outline.
const STRETCHES: usize = 400;

impl Whole {
    pub(crate) fn new(record: &Record, free_s: Vec<[f64; 2]>) -> Self {
        let samples: Vec<[f64; 2]> =
            record.stamps_s().iter().zip(record.values()).map(|(stamp, value)| [*stamp, *value]).collect();
        let outline = samples.chunks(samples.len().div_ceil(STRETCHES).max(1)).flat_map(|stretch| {
            let by_value = |one: &&[f64; 2], other: &&[f64; 2]| one[1].total_cmp(&other[1]);
            let ends = [stretch.iter().min_by(by_value), stretch.iter().max_by(by_value)];
            let mut ends: Vec<[f64; 2]> = ends.into_iter().flatten().copied().collect();
            ends.sort_by(|one, other| one[0].total_cmp(&other[0]));
            ends.dedup();
            ends
        });
        Self { free_s, outline: outline.collect() }
    }
}

/// Interpretation of a file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Reading {
    /// Whole interpretation in one line: `read as: …`.
    pub sentence: String,
    /// Format: `csv` or `host-log`.
    pub format: String,
    /// Separator of the columns: `comma`, `semicolon`, `tab`, `blank` or `bar`; `none` for a single column.
    pub separator: String,
    /// Decimal sign: `point` or `comma`.
    pub decimal: String,
    /// Line number of the header, from 1.
    pub header_line: u64,
    /// Number of the run, from 1, if the file holds several.
    pub run: Option<usize>,
    /// Time column; `None` if the samples are placed at a given rate.
    pub time: Option<ColumnReading>,
    /// That rate, in hertz.
    pub sample_rate_hz: Option<f64>,
    /// Observed column.
    pub value: ColumnReading,
    /// Number of counts that make a turn, if the observed numbers are counts.
    pub counts_per_turn: Option<f64>,
    /// Part of the time that was read, in seconds, if it is not the whole record.
    pub part_s: Option<[f64; 2]>,
    /// The whole record, if only a part was read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub whole: Option<Whole>,
    /// Column of the input.
    pub input: Option<ColumnReading>,
    /// Filter on the lines: `COLUMN=VALUE`.
    #[serde(rename = "where")]
    pub filter: Option<String>,
    /// Number of cells without a number in the columns that were read.
    pub missing_cells: usize,
    /// Number of lines with such cells.
    pub missing_lines: usize,
    /// Treatment of these cells.
    pub missing: Missing,
    /// Observed quantity.
    pub quantity: Quantity,
    /// Coordinate of the motion.
    pub coordinate: Coordinate,
}

impl Reading {
    /// Returns the options that read the file in the same way, as keys of the configuration's section `data`
    /// with their values. On the command line, `time_unit` is `--time-unit` and `sample_rate_hz` is
    /// `--sample-rate`.
    #[must_use]
    pub fn options(&self) -> Vec<(&'static str, String)> {
        let mut options = vec![("format", self.format.clone())];
        // The columns of a host log are fixed.
        if self.format != "host-log" {
            let mut column = |read: Option<&ColumnReading>, [name, unit]: [&'static str; 2]| {
                options.extend(read.map(|read| (name, read.column.clone())));
                options.extend(read.and_then(|read| read.unit.clone()).map(|symbol| (unit, symbol)));
            };
            column(self.time.as_ref(), ["time", "time_unit"]);
            column(Some(&self.value), ["value", "unit"]);
            column(self.input.as_ref(), ["input", "input_unit"]);
            options.extend(self.sample_rate_hz.map(|rate| ("sample_rate_hz", rate.to_string())));
            options.extend(self.counts_per_turn.map(|counts| ("counts_per_turn", counts.to_string())));
            options.extend(self.run.map(|run| ("run", run.to_string())));
            options.extend(self.filter.clone().map(|filter| ("where", filter)));
            if self.missing_cells > 0 {
                options.push(("missing", self.missing.name().to_owned()));
            }
        }
        let part = self.part_s.map(|[from, to]| [("from_s", from.to_string()), ("to_s", to.to_string())]);
        options.extend(part.into_iter().flatten());
        options.push(("quantity", self.quantity.name().to_owned()));
        options
    }

    /// Returns the reading with its sentence. `kind` is that of a file that is no text with columns.
    pub(crate) fn worded(self, rate_hz: f64, kind: Option<&str>) -> Self {
        let column = |role: &str, read: &ColumnReading| match &read.unit {
            Some(unit) if unit == TimeUnit::Iso.name() => {
                format!("{role} = \"{}\", dates or times of the day", read.column)
            }
            Some(unit) if read.because.contains("unit assumed") => {
                format!("{role} = \"{}\" in {unit} (assumed)", read.column)
            }
            Some(unit) => format!("{role} = \"{}\" in {unit}", read.column),
            None if read.because.contains("; counts, ") => format!("{role} = \"{}\" in counts", read.column),
            None => format!("{role} = \"{}\" as it is", read.column),
        };
        let mut first = match (self.format.as_str(), kind) {
            ("host-log", _) => "a host log".to_owned(),
            (_, Some(kind)) => kind.to_owned(),
            _ if self.separator == NO_SEPARATOR => "a single column".to_owned(),
            _ => format!("{}-separated", self.separator),
        };
        if self.decimal == "comma" {
            first.push_str(", decimal comma");
        }
        let mut parts = vec![first];
        parts.extend(self.run.map(|run| format!("run {run}")));
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
        parts.extend(self.part_s.map(|[from, to]| format!("from {from} s to {to} s")));
        Self { sentence: format!("read as: {}", parts.join("; ")), ..self }
    }

    /// Returns the number of missing cells and their treatment in words; `None` if no cell was missing.
    #[must_use]
    pub fn missing_in_words(&self) -> Option<String> {
        let done = match self.missing {
            Missing::Drop => "dropped",
            _ => "left as gaps",
        };
        (self.missing_cells > 0).then(|| format!("{} {done}", counted(self.missing_cells, "missing cell")))
    }
}
