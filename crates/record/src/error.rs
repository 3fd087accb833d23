//! Errors of records and record files.

use crate::words::counted;
use thiserror::Error;

/// Error of a record that cannot be used, with the file it was read from.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{file}{}: {fault}", fault.place())]
pub struct RecordError {
    /// Path of the file, as given by the user.
    pub file: String,
    /// The fault found.
    pub fault: Fault,
}

/// Fault of a record, without the name of its file.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Fault {
    /// The file could not be read.
    #[error("cannot be read: {problem}; expected a record file")]
    Unreadable {
        /// Error message of the operating system.
        problem: String,
    },
    /// The path names a folder.
    #[error("is a folder; expected a record file, name the file inside it")]
    Folder,
    /// The file is empty.
    #[error("is empty; expected a header and at least {needed} samples")]
    Empty {
        /// Smallest number of samples of a record.
        needed: usize,
    },
    /// The file has a known format that is not text.
    #[error("is {kind}, not a text file with columns; {remedy}")]
    OtherFormat {
        /// Format of the file.
        kind: &'static str,
        /// Instruction for extracting its columns.
        remedy: &'static str,
    },
    /// The file has a known format, and cannot be read.
    #[error("is {problem}")]
    Container {
        /// Format of the file, the problem, and what to do.
        problem: String,
    },
    /// The file contains bytes that are not text.
    #[error("is no text (byte {offset}); expected a text file with columns, in UTF-8, UTF-16 or Latin-1")]
    NotText {
        /// Offset of the first byte that is not text.
        offset: usize,
    },
    /// The header differs from what the format requires.
    #[error("the header is `{found}`; expected {expected}")]
    BadHeader {
        /// Line, from 1.
        line: u64,
        /// Line as written.
        found: String,
        /// Header that the format requires.
        expected: String,
    },
    /// The file has fewer runs than the number asked for.
    #[error("there is no run {asked}: the file holds {count}; set `data.run` to a number from 1 to {count}")]
    NoSuchRun {
        /// Number asked for, from 1.
        asked: usize,
        /// Number of runs in the file.
        count: usize,
    },
    /// The part of the time that is asked for holds too few samples.
    #[error(
        "between {from_s} s and {to_s} s lie {found} samples; a record needs at least {needed}. The file goes from \
         {first_s} s to {last_s} s: set `data.from_s` and `data.to_s` to times between them"
    )]
    EmptyPart {
        /// Start of the part, in seconds.
        from_s: f64,
        /// End of the part, in seconds.
        to_s: f64,
        /// Number of samples in it.
        found: usize,
        /// Smallest number of samples of a record.
        needed: usize,
        /// First stamp of the file, in seconds.
        first_s: f64,
        /// Last stamp of the file, in seconds.
        last_s: f64,
    },
    /// A column is missing.
    #[error("there is no column `{wanted}`; the columns are {found}. Set `{key}` to the column's name")]
    MissingColumn {
        /// Line of the header, from 1.
        line: u64,
        /// Name of the column, or the names that are searched for.
        wanted: String,
        /// Names in the header.
        found: String,
        /// Configuration key that names the column.
        key: &'static str,
    },
    /// The column chosen as the input is already the time or the observed quantity.
    #[error(
        "column `{column}` is the time or the observed quantity and cannot be the input as well; set `data.input` to another \
         column, or `data.value` to the observed one"
    )]
    InputIsTaken {
        /// Line of the header, from 1.
        line: u64,
        /// Name of the column.
        column: String,
    },
    /// There is neither a time column nor a sampling rate.
    #[error(
        "no column is a time by its name or its unit; the columns are {found}. Set `data.time` to the column's \
         name, or `data.sample_rate_hz` where the samples are even and have no stamps"
    )]
    NoTime {
        /// Line of the header, from 1.
        line: u64,
        /// Names in the header.
        found: String,
    },
    /// Several columns fit a role equally well.
    #[error("{found} could each be {what}; set `{key}` to the name of one")]
    Ambiguous {
        /// Line of the header, from 1.
        line: u64,
        /// Role of the column.
        what: &'static str,
        /// Names of the columns.
        found: String,
        /// Configuration key that names the column.
        key: &'static str,
    },
    /// The file contains the samples of several series.
    #[error(
        "column `{column}` distinguishes {count} series: {values}; choose one: set `data.where` to \
         {column}={example}"
    )]
    SeveralValues {
        /// Line of the header, from 1.
        line: u64,
        /// Column that distinguishes the series.
        column: String,
        /// Number of different values in the column.
        count: usize,
        /// The values.
        values: String,
        /// First of the values.
        example: String,
    },
    /// No line has the requested value.
    #[error("no line has `{value}` in column `{column}`, which holds {values}; correct `data.where`")]
    NoSuchValue {
        /// Name of the column.
        column: String,
        /// Requested value.
        value: String,
        /// Values that the column contains.
        values: String,
    },
    /// There are cells without a number, which the options refuse.
    #[error(
        "{}, the first in column `{column}`; set `data.missing` to segment to leave them as gaps, or to drop to \
         close up the lines around them", counted(*count, "missing cell")
    )]
    MissingCells {
        /// Line of the first such cell, from 1.
        line: u64,
        /// Column of the first such cell.
        column: String,
        /// Number of such cells.
        count: usize,
    },
    /// A line has fewer fields than the header.
    #[error("the line has {found} field{}; expected {expected}", if *found == 1 { "" } else { "s" })]
    MissingField {
        /// Line, from 1.
        line: u64,
        /// Number of fields found.
        found: usize,
        /// Number of fields expected.
        expected: usize,
    },
    /// A line has more fields than the header. Decimal commas are the usual cause; they would be read as
    /// other numbers.
    #[error(
        "{found} fields under a header of {expected}; expected a field for each column. Are there decimal commas between \
         commas? Write decimal points, or semicolons between the columns"
    )]
    ExtraFields {
        /// Line, from 1.
        line: u64,
        /// Number of fields found.
        found: usize,
        /// Number of fields in the header.
        expected: usize,
    },
    /// A field is not a number.
    #[error("{}", no_number(.text, .column))]
    NotANumber {
        /// Line, from 1.
        line: u64,
        /// Name of the column.
        column: String,
        /// Field as written.
        text: String,
    },
    /// A number is infinite or NaN.
    #[error("column `{column}` holds a value that is not finite; drop the line or repair the value")]
    NotFinite {
        /// Line, from 1.
        line: u64,
        /// Name of the column.
        column: String,
    },
    /// Time runs backward.
    #[error(
        "time runs backward, from {previous} s to {stamp} s; expected stamps that never decrease: \
         split the file where a new recording starts"
    )]
    TimeDecreases {
        /// Line of the later stamp, from 1.
        line: u64,
        /// Previous stamp, in seconds.
        previous: f64,
        /// Stamp that is smaller, in seconds.
        stamp: f64,
    },
    /// There are too few samples for a record.
    #[error("has {found} sample{}; a record needs at least {needed}", if *found == 1 { "" } else { "s" })]
    TooFewSamples {
        /// Number of samples found.
        found: usize,
        /// Smallest number of samples of a record.
        needed: usize,
    },
    /// All stamps are equal.
    #[error("every stamp is {stamp} s; expected time to pass")]
    NoTimePasses {
        /// The common stamp, in seconds.
        stamp: f64,
    },
    /// Columns have different lengths.
    #[error("column `{column}` has {found} entries for {stamps} stamps")]
    UnequalColumns {
        /// Name of the column.
        column: &'static str,
        /// Number of its entries.
        found: usize,
        /// Number of stamps.
        stamps: usize,
    },
}

impl Fault {
    /// Returns `:LINE` if the fault has a line, otherwise an empty text, as for a file without a header.
    fn place(&self) -> String {
        match self {
            Self::BadHeader { line, .. }
            | Self::NoTime { line, .. }
            | Self::InputIsTaken { line, .. }
            | Self::Ambiguous { line, .. }
            | Self::SeveralValues { line, .. }
            | Self::MissingCells { line, .. }
            | Self::MissingColumn { line, .. }
            | Self::MissingField { line, .. }
            | Self::ExtraFields { line, .. }
            | Self::NotANumber { line, .. }
            | Self::NotFinite { line, .. }
            | Self::TimeDecreases { line, .. }
                if *line > 0 =>
            {
                format!(":{line}")
            }
            _ => String::new(),
        }
    }

    /// Returns the fault with the name of its file.
    #[must_use]
    pub fn in_file(self, file: &str) -> RecordError {
        RecordError { file: file.to_owned(), fault: self }
    }
}

/// Returns the message for a cell that is not a number.
fn no_number(text: &str, column: &str) -> String {
    let has_decimal_comma = text.replacen(',', ".", 1).parse::<f64>().is_ok();
    match text {
        "" => format!("an empty cell in column `{column}`; expected a number"),
        _ if has_decimal_comma => {
            format!("`{text}` in column `{column}` is not a number; write a decimal point")
        }
        _ => format!("`{text}` in column `{column}` is not a number"),
    }
}
