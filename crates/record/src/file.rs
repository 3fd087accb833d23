//! Reading of a file into a record and its source.

use crate::container;
use crate::csv_file;
use crate::error::{Fault, RecordError};
use crate::host_log;
use crate::options::{Format, ReadOptions};
use crate::reading::Reading;
use crate::record::Record;
use crate::statement::Statements;
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
        let text = match container::text(bytes) {
            Some(table) => {
                Cow::Owned(table.map_err(|unread| Fault::Unreadable { problem: unread.to_string() })?)
            }
            None => text_of(bytes)?,
        };
        // Spreadsheets write a byte-order mark at the beginning.
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        if text.trim().is_empty() {
            return Err(Fault::Empty { needed: crate::FEWEST_SAMPLES });
        }
        match options.format {
            Format::HostLog => host_log::parse(text),
            Format::Auto if is_host_log(text, options) => host_log::parse(text),
            Format::Auto | Format::Csv => csv_file::parse(text, options),
        }?
        .finish(options)
    };
    let (record, statements, findings, reading) = parse().map_err(|fault| fault.in_file(name))?;
    let source = Source { path: name.to_owned(), digest: digest(bytes), statements, findings, reading };
    Ok((record, source))
}

/// Formats that contain logs but are not text: first bytes, name of the format, and instruction for
/// extracting the columns.
const OTHERS: &[(&[u8], &str, &str)] = &[
    (b"PK\x03\x04", "a ZIP archive, as Excel's workbooks (.xlsx) are", "save the sheet as CSV"),
    (b"\xd0\xcf\x11\xe0", "an Excel workbook (.xls)", "save the sheet as CSV"),
    (b"PAR1", "a Parquet file", "from Python, ringdown_lab.logs.read_parquet reads it"),
    (b"MATLAB 5.0", "a MATLAB file", "from Python, ringdown_lab.logs.read_mat reads it"),
    (b"\x89HDF", "an HDF5 file, as MATLAB's of version 7.3 are", "save the columns as CSV"),
    (b"\x89MCAP", "an MCAP file", "from Python, ringdown_lab.logs.read_mcap reads it"),
    (b"#ROSBAG", "a ROS bag", "from Python, ringdown_lab.logs.read_rosbag reads it"),
    (
        b"SQLite format 3",
        "an SQLite database, as a ROS 2 bag is",
        "from Python, ringdown_lab.logs.read_rosbag reads a bag",
    ),
];

/// Decodes bytes as UTF-8, as UTF-16 if they begin with its byte-order mark, else as Latin-1, which older
/// loggers and spreadsheets write. Bytes that are no text are a fault.
pub(crate) fn text_of(bytes: &[u8]) -> Result<Cow<'_, str>, Fault> {
    if let Some((_, kind, remedy)) =
        OTHERS.iter().copied().find(|(beginning, ..)| bytes.starts_with(beginning))
    {
        return Err(Fault::OtherFormat { kind, remedy });
    }
    let error = match std::str::from_utf8(bytes) {
        // A program or a dump can be valid UTF-8 by chance, but no line of text contains a NUL.
        Ok(text) => match text.find('\0') {
            Some(offset) => Fault::NotText { offset },
            None => return Ok(Cow::Borrowed(text)),
        },
        Err(error) => Fault::NotText { offset: error.valid_up_to() },
    };
    let units = |from: fn([u8; 2]) -> u16| -> Vec<u16> {
        bytes.chunks_exact(2).filter_map(|pair| Some(from(pair.try_into().ok()?))).collect()
    };
    match bytes {
        [0xff, 0xfe, ..] => String::from_utf16(&units(u16::from_le_bytes)).map(Cow::Owned).map_err(|_| error),
        [0xfe, 0xff, ..] => String::from_utf16(&units(u16::from_be_bytes)).map(Cow::Owned).map_err(|_| error),
        _ if bytes.iter().any(|byte| byte.is_ascii_control() && !byte.is_ascii_whitespace()) => Err(error),
        _ => Ok(Cow::Owned(bytes.iter().map(|byte| char::from(*byte)).collect())),
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
