//! Options for reading a record file.

use crate::columns::CsvColumns;
use crate::reading::Coordinate;
use crate::record::Quantity;
use serde::{Deserialize, Serialize};

/// Format of a record file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// By the first line.
    #[default]
    Auto,
    /// A header with column names, then numbers, with commas, semicolons, tabs or blanks between them; lines that
    /// start with `#`, `%` or `//` are comments, of which `# origin: …`, `# sample_rate_hz: …` and `# samples: …` are
    /// statements.
    Csv,
    /// Two header lines, then `wall clock, elapsed s, angle deg`.
    HostLog,
}

impl Format {
    /// Every format's name as configurations write it.
    pub const NAMES: &'static [&'static str] = &["auto", "csv", "host-log"];
}

/// How to read a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// Format of the file.
    pub format: Format,
    /// Columns and units of a `csv` file; a `host-log` has its own.
    pub columns: CsvColumns,
    /// What the sensor observes; left open, what the column's unit and name say, else a position.
    pub quantity: Option<Quantity>,
    /// What moves, where that is known: columns of that dimension are preferred, and what states no unit is in its SI
    /// unit.
    pub coordinate: Option<Coordinate>,
    /// Whether an input is known to drive the system: a command or a voltage is then taken for it too.
    pub driven: bool,
}
