//! Reader of NumPy's archives (`.npz`): ZIP archives of array files.
//!
//! Sources: the documentation of `numpy.savez`; PKWARE, *APPNOTE.TXT – .ZIP File Format Specification*.

use super::bytes::{length_at, number_at};
use super::npy::Array;
use super::sheet::{Cell, Column, named};
use super::unread::Unread;
use flate2::Crc;
use flate2::read::DeflateDecoder;
use std::borrow::Cow;
use std::io::Read;

/// Largest size of all unpacked arrays, in bytes: an archive can be a thousand times smaller than that.
pub(super) const LARGEST: usize = 1 << 28;
/// Beginning of an entry.
const LOCAL: &[u8] = b"PK\x03\x04";
/// Number of bytes of the end of the directory, without the comment after it.
const END: usize = 22;

/// An entry of the archive's directory.
struct Entry {
    name: String,
    /// Method: 0 for stored, 8 for deflated.
    method: u64,
    /// CRC-32 of the unpacked bytes.
    check: u64,
    /// Number of bytes in the archive.
    packed: usize,
    /// Number of bytes when unpacked.
    size: usize,
    /// Offset of the entry.
    at: usize,
}

/// Returns the table of an archive that holds only array files.
pub(super) fn text(bytes: &[u8]) -> Option<Result<String, Unread>> {
    if !bytes.starts_with(LOCAL) {
        return None;
    }
    let text = match entries(bytes) {
        Some(entries) if entries.is_empty() || !entries.iter().all(|entry| is_array(&entry.name)) => {
            return None;
        }
        Some(entries) => table(bytes, &entries),
        None => {
            let first = bytes.get(30..30 + length_at(bytes, 26, 2)?)?;
            if !is_array(&String::from_utf8_lossy(first)) {
                return None;
            }
            Err("it is incomplete: its directory is missing".to_owned())
        }
    };
    Some(text.map_err(|problem| {
        Unread {
            kind: "a NumPy archive (.npz)",
            problem,
            remedy: "write a table of numbers, in Python with\n    \
                 import numpy; data = numpy.load('in.npz', allow_pickle=True); print(data.files)\n    \
                 numpy.savetxt('out.csv', numpy.c_[data['time'], data['angle']], delimiter=',', \
                 header='time_s,angle_rad', comments='')"
                .to_owned(),
        }
    }))
}

fn is_array(name: &str) -> bool {
    name.ends_with(".npy")
}

/// Returns the entries of the directory at the end of the archive.
fn entries(bytes: &[u8]) -> Option<Vec<Entry>> {
    // A comment of up to 65,535 bytes may follow the end of the directory.
    let lowest = bytes.len().saturating_sub(END + 0xffff);
    let end = (lowest..=bytes.len().checked_sub(END)?)
        .rev()
        .find(|at| bytes.get(*at..).is_some_and(|rest| rest.starts_with(b"PK\x05\x06")))?;
    let (count, mut at) = (length_at(bytes, end + 10, 2)?, length_at(bytes, end + 16, 4)?);
    let mut found = Vec::new();
    for _ in 0..count {
        if !bytes.get(at..)?.starts_with(b"PK\x01\x02") {
            return None;
        }
        let length = |offset: usize, size: usize| length_at(bytes, at + offset, size);
        let (name, extra, comment) = (length(28, 2)?, length(30, 2)?, length(32, 2)?);
        found.push(Entry {
            name: String::from_utf8_lossy(bytes.get(at + 46..at + 46 + name)?).into_owned(),
            method: number_at(bytes, at + 10, 2)?,
            check: number_at(bytes, at + 16, 4)?,
            packed: length(20, 4)?,
            size: length(24, 4)?,
            at: length(42, 4)?,
        });
        at += 46 + name + extra + comment;
    }
    Some(found)
}

impl Entry {
    /// Returns the unpacked bytes.
    fn unpack<'a>(&self, bytes: &'a [u8]) -> Result<Cow<'a, [u8]>, String> {
        let damaged = || format!("its array `{}` is damaged", self.name);
        let packed = self.packed(bytes).ok_or_else(damaged)?;
        let content = match self.method {
            0 => Cow::Borrowed(packed),
            8 => {
                let mut content = Vec::new();
                // No more is unpacked than the directory announces, even if there is more.
                let limit = self.size as u64 + 1;
                let read = DeflateDecoder::new(packed).take(limit).read_to_end(&mut content);
                read.map_err(|_| damaged())?;
                Cow::Owned(content)
            }
            method => return Err(format!("its arrays are packed by method {method} instead of deflate")),
        };
        let mut crc = Crc::new();
        crc.update(&content);
        let whole = content.len() == self.size && u64::from(crc.sum()) == self.check;
        if whole { Ok(content) } else { Err(damaged()) }
    }

    /// Returns the bytes as they are in the archive.
    fn packed<'a>(&self, bytes: &'a [u8]) -> Option<&'a [u8]> {
        let entry = bytes.get(self.at..)?;
        let start = 30 + length_at(entry, 26, 2)? + length_at(entry, 28, 2)?;
        entry.starts_with(LOCAL).then(|| entry.get(start..start.checked_add(self.packed)?))?
    }
}

fn table(bytes: &[u8], entries: &[Entry]) -> Result<String, String> {
    let size = entries.iter().fold(0_usize, |sum, entry| sum.saturating_add(entry.size));
    if size > LARGEST {
        return Err(format!("it unpacks to {} MB and at most {} MB are read", size >> 20, LARGEST >> 20));
    }
    let contents: Vec<Cow<'_, [u8]>> =
        entries.iter().map(|entry| entry.unpack(bytes)).collect::<Result<_, _>>()?;
    let (mut arrays, mut fault) = (Vec::new(), None);
    for (entry, content) in entries.iter().zip(&contents) {
        let name = entry.name.trim_end_matches(".npy");
        match Array::parse(content) {
            Ok(array) => arrays.push((name, array)),
            // Objects and pictures may lie beside the columns.
            Err(problem) => {
                fault.get_or_insert(format!("of its array `{name}`, {problem}"));
            }
        }
    }
    side_by_side(arrays).map_err(|problem| fault.unwrap_or(problem))
}

/// Writes arrays with their names as a table. Single numbers become remarks; a table alone keeps its columns
/// without its name.
///
/// # Errors
/// A clause about columns of different lengths, or that there are none.
pub(super) fn side_by_side<N: AsRef<str>>(mut arrays: Vec<(N, Array<'_>)>) -> Result<String, String> {
    let remark = |(name, array): &(N, Array<'_>)| Some((name.as_ref().to_owned(), single(array)?));
    let remarks: Vec<(String, String)> = arrays.iter().filter_map(remark).collect();
    arrays.retain(|(_, array)| array.single().is_none());
    if let [(_, array)] = arrays.as_slice()
        && array.is_nameless()
        && array.has_two_sides()
    {
        return Ok(array.table(&remarks));
    }
    let alone = arrays.len() == 1;
    let columns: Vec<Column<'_>> = arrays
        .iter()
        .flat_map(|(name, array)| {
            array.columns(if alone && !array.is_nameless() { "" } else { name.as_ref() })
        })
        .collect();
    named(&columns, &remarks)
}

/// Returns the only number or text of an array, as text.
fn single(array: &Array<'_>) -> Option<String> {
    match array.single()? {
        Cell::Float(number) => Some(number.to_string()),
        Cell::Single(number) => Some(number.to_string()),
        Cell::Integer(number) => Some(number.to_string()),
        Cell::Text(text) => Some(text),
        Cell::Missing => None,
    }
}
