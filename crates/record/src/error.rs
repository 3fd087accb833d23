//! What can be wrong with a record.

use crate::words::counted;
use thiserror::Error;

/// A record that cannot be used, with the file it was read from.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{file}{}: {fault}", fault.place())]
pub struct RecordError {
    /// The file, as it was named.
    pub file: String,
    /// What is wrong with it.
    pub fault: Fault,
}

/// What is wrong with a record, without the name of its file.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Fault {
    /// The file could not be read.
    #[error("cannot be read: {problem}; expected a record file")]
    Unreadable {
        /// What the system says.
        problem: String,
    },
    /// The path names a folder.
    #[error("is a folder; expected a record file, name the file inside it")]
    Folder,
    /// There is nothing in it.
    #[error("is empty; expected a header and at least {needed} samples")]
    Empty {
        /// Fewest samples that make a record.
        needed: usize,
    },
    /// The file is of a kind that is known, and no text.
    #[error("is {kind}, not a text file with columns; {remedy}")]
    OtherFormat {
        /// Kind of the file.
        kind: &'static str,
        /// How to get at its columns.
        remedy: &'static str,
    },
    /// Bytes that no text holds.
    #[error("is no text (byte {offset}); expected a text file with columns, in UTF-8, UTF-16 or Latin-1")]
    NotText {
        /// Offset of the first byte that is not text.
        offset: usize,
    },
    /// The header is not what the format prescribes.
    #[error("the header is `{found}`; expected {expected}")]
    BadHeader {
        /// Line, from 1.
        line: u64,
        /// The line as written.
        found: String,
        /// What the format prescribes.
        expected: String,
    },
    /// Numbers where the columns' names should be.
    #[error(
        "the first line holds numbers, `{found}`; expected a header with the columns' names above them: put a line \
         such as time_s{separator}angle_rad in front"
    )]
    NoHeader {
        /// The first line's number, from 1.
        line: u64,
        /// The line as written, its beginning.
        found: String,
        /// The sign between its cells.
        separator: char,
    },
    /// A column is not there.
    #[error("there is no column `{wanted}`; the header has {found}. Set `{key}` to the column's name")]
    MissingColumn {
        /// Line of the header, from 1.
        line: u64,
        /// The column's name, or the names that are looked for.
        wanted: String,
        /// The header's names.
        found: String,
        /// The configuration key that names the column.
        key: &'static str,
    },
    /// The input is the time or the observed quantity.
    #[error(
        "column `{column}` is the time or the observed quantity and cannot be the input as well; set `data.input` to another \
         column, or `data.value` to the observed one"
    )]
    InputIsTaken {
        /// Line of the header, from 1.
        line: u64,
        /// The column.
        column: String,
    },
    /// Neither a time column nor a rate.
    #[error(
        "no column is a time by its name or its unit; the header has {found}. Set `data.time` to the column's \
         name, or `data.sample_rate_hz` where the samples are even and have no stamps"
    )]
    NoTime {
        /// Line of the header, from 1.
        line: u64,
        /// The header's names.
        found: String,
    },
    /// Several columns could each be the one that is looked for.
    #[error("{found} could each be {what}; set `{key}` to the name of one")]
    Ambiguous {
        /// Line of the header, from 1.
        line: u64,
        /// What is looked for.
        what: &'static str,
        /// The columns.
        found: String,
        /// The configuration key that names the column.
        key: &'static str,
    },
    /// The samples of several series stand in one file.
    #[error(
        "column `{column}` tells {count} series apart: {values}; choose one: set `data.where` to {column}={example}"
    )]
    SeveralValues {
        /// Line of the header, from 1.
        line: u64,
        /// The column that tells them apart.
        column: String,
        /// Number of its values.
        count: usize,
        /// Its values.
        values: String,
        /// The first of them.
        example: String,
    },
    /// No line has the value that is asked for.
    #[error("no line has `{value}` in column `{column}`, which holds {values}; correct `data.where`")]
    NoSuchValue {
        /// The column.
        column: String,
        /// The value asked for.
        value: String,
        /// Values that the column has.
        values: String,
    },
    /// Cells without a number, where these are refused.
    #[error(
        "{}, the first in column `{column}`; set `data.missing` to segment to leave them as gaps, or to drop to \
         close up the lines around them", counted(*count, "missing cell")
    )]
    MissingCells {
        /// Line of the first, from 1.
        line: u64,
        /// Its column.
        column: String,
        /// Number of them.
        count: usize,
    },
    /// A line has fewer fields than the header.
    #[error("the line has {found} field{}; expected {expected}", if *found == 1 { "" } else { "s" })]
    MissingField {
        /// Line, from 1.
        line: u64,
        /// Fields found.
        found: usize,
        /// Fields expected.
        expected: usize,
    },
    /// A line has more fields than the header: decimal commas, which would be read as other numbers.
    #[error(
        "{found} fields under a header of {expected}; expected a field for each column. Are there decimal commas between \
         commas? Write decimal points, or semicolons between the columns"
    )]
    ExtraFields {
        /// Line, from 1.
        line: u64,
        /// Fields found.
        found: usize,
        /// Fields of the header.
        expected: usize,
    },
    /// A field is not a number.
    #[error("{}", no_number(.text, .column))]
    NotANumber {
        /// Line, from 1.
        line: u64,
        /// The column's name.
        column: String,
        /// The field as written.
        text: String,
    },
    /// A number is infinite or no number.
    #[error("column `{column}` holds a value that is not finite; drop the line or repair the value")]
    NotFinite {
        /// Line, from 1.
        line: u64,
        /// The column's name.
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
        /// The stamp before, in seconds.
        previous: f64,
        /// The stamp, in seconds.
        stamp: f64,
    },
    /// Too short to be a record.
    #[error("has {found} sample{}; a record needs at least {needed}", if *found == 1 { "" } else { "s" })]
    TooFewSamples {
        /// Samples found.
        found: usize,
        /// Fewest samples that make a record.
        needed: usize,
    },
    /// Every stamp is the same.
    #[error("every stamp is {stamp} s; expected time to pass")]
    NoTimePasses {
        /// The stamp, in seconds.
        stamp: f64,
    },
    /// Columns of different lengths.
    #[error("column `{column}` has {found} entries for {stamps} stamps")]
    UnequalColumns {
        /// Which column.
        column: &'static str,
        /// Its entries.
        found: usize,
        /// The stamps.
        stamps: usize,
    },
}

impl Fault {
    /// `:LINE` where the fault has a line, otherwise nothing.
    fn place(&self) -> String {
        match self {
            Self::BadHeader { line, .. }
            | Self::NoHeader { line, .. }
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
            | Self::TimeDecreases { line, .. } => format!(":{line}"),
            _ => String::new(),
        }
    }

    /// The fault with the name of its file.
    #[must_use]
    pub fn in_file(self, file: &str) -> RecordError {
        RecordError { file: file.to_owned(), fault: self }
    }
}

/// What is wrong with a cell that is no number.
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
