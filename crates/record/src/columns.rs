//! Columns of a `csv` file as options name them.

use crate::unit::{TimeUnit, Unit};
use serde::{Deserialize, Serialize};

/// Which columns to read and how. What is left open is found from the file and kept in [`Reading`](crate::Reading).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CsvColumns {
    /// The time column.
    pub time: Option<String>,
    /// The observed column.
    pub value: Option<String>,
    /// The measured input; absent where there is none.
    pub input: Option<String>,
    /// Unit of the observed column; left open, what the header says, else the SI unit of what moves.
    pub unit: Option<Unit>,
    /// Unit of the input; left open, what the header says, else as it is.
    pub input_unit: Option<Unit>,
    /// Unit of the time column; left open, what the header or the numbers say, else seconds.
    pub time_unit: Option<TimeUnit>,
    /// Rate at which to lay out a file without a time column, in hertz; a statement to be checked where there is one.
    pub sample_rate_hz: Option<f64>,
    /// Lines to read; left open, all.
    pub filter: Option<Filter>,
    /// What cells without a number mean.
    pub missing: Missing,
}

/// Lines with a value in a column, written `COLUMN=VALUE`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Filter {
    /// The column.
    pub column: String,
    /// The value that its cells have.
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

/// What a cell without a number (empty, `NaN`, `NA`, `null`, `-`, infinite) means in a column that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Missing {
    /// A gap: the line is left out and its place in time stays empty; where the observed cell alone is missing its input is
    /// kept ([`Record::input_rows`](crate::Record::input_rows)). Clocks that are even in the index count it, and
    /// samples on either side of it are no neighbors.
    #[default]
    Segment,
    /// A line that is not there, as if the file had never had it: in a file that is laid out at a rate, and on a clock that
    /// is even in the index, the following samples move up. Stamps stay as written.
    Drop,
    /// A fault.
    Refuse,
}

impl Missing {
    /// Every choice's name as configurations write it.
    pub const NAMES: &'static [&'static str] = &["segment", "drop", "refuse"];

    /// The name as configurations write it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Segment => "segment",
            Self::Drop => "drop",
            Self::Refuse => "refuse",
        }
    }
}
