//! Choice of the columns of a `csv` file by options.

use crate::unit::{TimeUnit, Unit};
use serde::{Deserialize, Serialize};

/// Columns to read and their interpretation. Settings that are left open are found from the file and stored
/// in [`Reading`](crate::Reading).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CsvColumns {
    /// Name of the time column.
    pub time: Option<String>,
    /// Name of the observed column.
    pub value: Option<String>,
    /// Name of the column of the measured input, or `none` for no input; by default found from the header.
    pub input: Option<String>,
    /// Unit of the observed column; by default that of the header, else the SI unit of the coordinate.
    pub unit: Option<Unit>,
    /// Unit of the input; by default that of the header, else none: the numbers are used as they are.
    pub input_unit: Option<Unit>,
    /// Unit of the time column; by default that of the header or the one that the numbers imply, else
    /// seconds.
    pub time_unit: Option<TimeUnit>,
    /// Sampling rate in hertz. It places the samples of a file without a time column; in a file with one it
    /// is a statement to be checked.
    pub sample_rate_hz: Option<f64>,
    /// Number, from 1, of the run to read, if the file holds several, each with its own time; by default the
    /// first.
    pub run: Option<usize>,
    /// Number of counts of an encoder that make one turn: the values are counts. A stated unit is used
    /// instead, if there is one in the options.
    pub counts_per_turn: Option<f64>,
    /// Filter on the lines to read; by default all lines are read.
    pub filter: Option<Filter>,
    /// Treatment of cells without a number.
    pub missing: Missing,
}

/// Filter on lines with a certain value in a column, written `COLUMN=VALUE`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Filter {
    /// Name of the column.
    pub column: String,
    /// Value of the column's cells in the chosen lines.
    pub value: String,
}

impl TryFrom<String> for Filter {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let (column, value) = text
            .split_once('=')
            .ok_or_else(|| format!("`{text}`; expected COLUMN=VALUE, such as joint=elbow"))?;
        Ok(Self { column: column.trim().to_owned(), value: value.trim().to_owned() })
    }
}

impl From<Filter> for String {
    fn from(filter: Filter) -> Self {
        format!("{}={}", filter.column, filter.value)
    }
}

/// Treatment of a cell without a number (empty, `NaN`, `NA`, `null`, `-`, infinite) in a column that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Missing {
    /// Gap: the line is left out and its place in time stays empty. If only the observed cell is missing, the
    /// input is kept ([`Record::input_rows`](crate::Record::input_rows)). Clocks that are even in the index
    /// count the line, and samples on its two sides are not neighbors.
    #[default]
    Segment,
    /// Deletion: the line is treated as if the file had never had it. In a file without stamps, and on a
    /// clock that is even in the index, the following samples move up. Stamps stay as written.
    Drop,
    /// Error: the file is refused.
    Refuse,
}

impl Missing {
    /// Names of all choices in configurations.
    pub const NAMES: &'static [&'static str] = &["segment", "drop", "refuse"];

    /// Returns the name used in configurations.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Segment => "segment",
            Self::Drop => "drop",
            Self::Refuse => "refuse",
        }
    }
}
