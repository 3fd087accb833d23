//! Reading of a file into a record and its source.

use crate::container::{self, Contained};
use crate::csv_file;
use crate::error::{Fault, RecordError};
use crate::host_log;
use crate::options::{Format, ReadOptions};
use crate::reading::Reading;
use crate::record::Record;
use crate::statement::Statements;
use crate::text::text_of;
use sha2::{Digest, Sha256};
use std::borrow::Cow;
use std::path::Path;

/// Source of a record: information for people that is kept from estimators and from the diagnosis.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Path as given by the user.
    pub path: String,
    /// SHA-256 of the file's bytes: `sha256:` and 64 hexadecimal digits.
    pub digest: String,
    /// Statements in the file about itself.
    pub statements: Statements,
    /// Remarks from reading the file, as sentences.
    pub findings: Vec<String>,
    /// Interpretation of the file: columns, units and other decisions.
    pub reading: Reading,
}

/// Reads a record file.
///
/// # Errors
/// [`RecordError`] with the path, the line if there is one, the fault found and what was expected.
pub fn read_file(path: &Path, options: &ReadOptions) -> Result<(Record, Source), RecordError> {
    read_text(&path.display().to_string(), &bytes_of(path)?, options)
}

/// Reads a record from the bytes of a file; messages refer to the file as `name`.
///
/// # Errors
/// As [`read_file`].
pub fn read_text(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<(Record, Source), RecordError> {
    let parse = || {
        let (text, kind) = table_text(bytes)?;
        // Spreadsheets write a byte-order mark at the beginning.
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        if text.trim().is_empty() {
            return Err(Fault::Empty { needed: crate::FEWEST_SAMPLES });
        }
        let mut parsed = match options.format {
            Format::HostLog => host_log::parse(text),
            Format::Auto if is_host_log(text, options) => host_log::parse(text),
            Format::Auto | Format::Csv => csv_file::parse(text, options),
        }?;
        parsed.kind = kind;
        parsed.finish(options)
    };
    let (record, statements, findings, reading) = parse().map_err(|fault| fault.in_file(name))?;
    let source = Source { path: name.to_owned(), digest: digest(bytes), statements, findings, reading };
    Ok((record, source))
}

/// Returns the text of a table: that of the file, or the one into which its container is turned, with the kind
/// of the container.
pub(crate) fn table_text(bytes: &[u8]) -> Result<(Cow<'_, str>, Option<&'static str>), Fault> {
    match container::table(bytes) {
        Some(Ok(Contained { kind, text })) => Ok((Cow::Owned(text), Some(kind))),
        Some(Err(unread)) => Err(Fault::Container { problem: unread.to_string() }),
        None => Ok((text_of(bytes)?, None)),
    }
}

/// Returns `true` if the first line is that of a host log and the options name no column.
fn is_host_log(text: &str, options: &ReadOptions) -> bool {
    let columns = &options.columns;
    columns.time.is_none()
        && columns.value.is_none()
        && text.lines().next().is_some_and(|line| host_log::is_header(line.split(',')))
}

/// Returns the digest of a record file, as in [`Source::digest`], without parsing the file.
///
/// # Errors
/// [`RecordError`] with the path if the file cannot be read.
pub fn file_digest(path: &Path) -> Result<String, RecordError> {
    Ok(digest(&bytes_of(path)?))
}

pub(crate) fn bytes_of(path: &Path) -> Result<Vec<u8>, RecordError> {
    let fault = match std::fs::read(path) {
        Ok(bytes) => return Ok(bytes),
        Err(_) if path.is_dir() => Fault::Folder,
        Err(error) => Fault::Unreadable { problem: error.to_string() },
    };
    Err(fault.in_file(&path.display().to_string()))
}

fn digest(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold("sha256:".to_owned(), |text, byte| text + &format!("{byte:02x}"))
}
