//! First look at a log: everything that a reader finds out without options.

use crate::clock::{Clock, ClockChoice};
use crate::error::RecordError;
use crate::file::{Source, read_text, table_text};
use crate::options::ReadOptions;
use crate::record::Record;
use crate::roles::Kind;
use crate::table::Table;

/// Findings about a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Look {
    /// The record.
    pub record: Record,
    /// Source of the record with [`Source::reading`]: dialect, columns, units, quantity, coordinate, missing
    /// cells, and [`crate::Reading::options`], which reproduce the reading.
    pub source: Source,
    /// All columns; empty for a host log.
    pub columns: Vec<ColumnLook>,
    /// Clock chosen from stamps and values, with the sampling rate.
    pub clock: Clock,
}

/// A column of the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnLook {
    /// Title as written.
    pub title: String,
    /// Symbol of the unit stated by the title.
    pub unit: Option<String>,
    /// `time`, `value` or `input`; `None` if the column is not read.
    pub role: Option<&'static str>,
    /// Content of the cells: `numbers`, `dates` or `text`.
    pub holds: &'static str,
    /// Reason for the role, as a phrase.
    pub because: Option<String>,
}

/// Reads a record from the bytes of a file and reports the findings; `name` is its name in messages.
///
/// # Errors
/// As [`crate::read_text`]. If the file is not clear enough, the message names the option to set.
pub fn look(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Look, RecordError> {
    let (record, source) = read_text(name, bytes, options)?;
    let clock = Clock::new(&record, ClockChoice::Auto).map_err(|fault| fault.in_file(name))?;
    let (text, _) = table_text(bytes).map_err(|fault| fault.in_file(name))?;
    let columns = match source.reading.format.as_str() {
        "csv" => columns(text.trim_start_matches('\u{feff}'), &source),
        _ => Vec::new(),
    };
    Ok(Look { record, source, columns, clock })
}

fn columns(text: &str, source: &Source) -> Vec<ColumnLook> {
    let reading = &source.reading;
    let roles =
        [("time", reading.time.as_ref()), ("value", Some(&reading.value)), ("input", reading.input.as_ref())];
    let columns = Table::new(text).into_iter().flat_map(|table| table.columns);
    let look = |column: crate::roles::Column| {
        let role =
            roles.iter().find(|(_, read)| read.is_some_and(|read| read.column == column.heading.title));
        let time = column.heading.time_unit().map(|unit| unit.name().to_owned());
        ColumnLook {
            unit: time.or(column.heading.unit().map(|unit| unit.symbol().to_owned())),
            role: role.map(|(role, _)| *role),
            holds: match column.kind {
                Kind::Numbers => "numbers",
                Kind::Dates => "dates",
                Kind::Text => "text",
            },
            because: role.and_then(|(_, read)| read.map(|read| read.because.clone())),
            title: column.heading.title,
        }
    };
    columns.into_iter().map(look).collect()
}

/// Titles of a table, and the series that it holds in long form.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Titles {
    /// Titles of all columns, as written.
    pub titles: Vec<String>,
    /// Title of the column `joint` and its values, in the order of their first lines; `None` without one.
    pub joints: Option<(String, Vec<String>)>,
}

/// Reads the titles of the table in the bytes of a file; `name` is its name in messages.
///
/// # Errors
/// [`RecordError`] for bytes that hold no table.
pub fn titles(name: &str, bytes: &[u8]) -> Result<Titles, RecordError> {
    let read = || {
        let (text, _) = table_text(bytes)?;
        let table = Table::new(text.trim_start_matches('\u{feff}'))?;
        let titles: Vec<String> = table.columns.iter().map(|own| own.heading.title.clone()).collect();
        let joint = titles.iter().position(|title| title.trim().eq_ignore_ascii_case("joint"));
        let joints = joint.map(|at| {
            let values = table.values(at).into_iter().map(str::to_owned).collect();
            (table.title(at).to_owned(), values)
        });
        Ok(Titles { titles, joints })
    };
    read().map_err(|fault: crate::error::Fault| fault.in_file(name))
}
