//! Options for reading a record file.

use crate::columns::CsvColumns;
use crate::reading::Coordinate;
use crate::record::Quantity;
use serde::{Deserialize, Serialize};

/// Format of a record file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// Determined from the first line.
    #[default]
    Auto,
    /// A header with column names, then numbers, separated by commas, semicolons, tabs or blanks. Lines that
    /// start with `#`, `%` or `//` are comments; the comments `# origin: …`, `# sample_rate_hz: …` and `#
    /// samples: …` are statements about the record.
    Csv,
    /// Two header lines, then `wall clock, elapsed s, angle deg`.
    HostLog,
}

impl Format {
    /// Names of all formats in configurations.
    pub const NAMES: &'static [&'static str] = &["auto", "csv", "host-log"];
}

/// Options for reading a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// Format of the file.
    pub format: Format,
    /// Columns and units of a `csv` file; those of a `host-log` are fixed.
    pub columns: CsvColumns,
    /// Observed quantity; by default that of the column's unit or name, else a position.
    pub quantity: Option<Quantity>,
    /// Coordinate of the motion, if it is known: columns of its dimension are preferred, and values without a
    /// stated unit are in its SI unit.
    pub coordinate: Option<Coordinate>,
    /// Start of the part of the time to read, in seconds as the stamps are read; by default the whole record,
    /// or the part of it in which the system swings freely.
    pub from_s: Option<f64>,
    /// End of that part, in seconds.
    pub to_s: Option<f64>,
    /// `true` if an input is known to drive the system: a command or a voltage is then accepted as the input
    /// too.
    pub driven: bool,
}
