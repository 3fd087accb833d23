//! Reader of MATLAB's files (`.mat`) of version 5, which MATLAB writes up to version 7.2 of the format, as do
//! Octave (`save -v7`) and `scipy.io.savemat`. Version 7.3 is HDF5 and is refused with the lines that convert it.
//!
//! Source: The MathWorks, *MAT-File Format*, chapter 1, "Level 5 MAT-File Format".

#![allow(clippy::indexing_slicing, reason = "the end of the header was read")]

use super::bytes::number_at;
use super::npy::Array;
use super::npz::{LARGEST, side_by_side};
use super::unread::Unread;
use flate2::read::ZlibDecoder;
use std::borrow::Cow;
use std::io::Read;

/// Length of the header, in bytes.
const HEADER: usize = 128;
/// Types of elements.
const COMPRESSED: u64 = 15;
const MATRIX: u64 = 14;
/// Structures within structures that are followed.
const DEEPEST: usize = 8;

/// An element: its type and its bytes.
struct Element<'a> {
    kind: u64,
    bytes: &'a [u8],
}

/// Bytes that are read from the front, in the byte order of the file.
struct Bytes<'a> {
    rest: &'a [u8],
    big_endian: bool,
}

/// Variables that were read, and why the first of the others was not.
#[derive(Default)]
struct Found<'a> {
    arrays: Vec<(String, Array<'a>)>,
    fault: Option<String>,
}

/// Returns the table of a MATLAB file.
pub(super) fn text(bytes: &[u8]) -> Option<Result<String, Unread>> {
    let convert = |problem: String, line: &str| Unread {
        kind: "a MATLAB file (.mat)",
        problem,
        remedy: format!(
            "write its columns as text, in MATLAB with writematrix([t(:) angle(:)], 'out.csv'), or in Python with\n    \
             {line}\n    \
             numpy.savetxt('out.csv', numpy.c_[numpy.ravel(m['t']), numpy.ravel(m['angle'])], delimiter=',', \
             header='time_s,angle_rad', comments='')"
        ),
    };
    if bytes.starts_with(b"MATLAB 7.3") {
        let problem = "of version 7.3, which is HDF5 and not read".to_owned();
        return Some(Err(convert(problem, "import h5py, numpy; m = h5py.File('in.mat'); print(list(m))")));
    }
    bytes.starts_with(b"MATLAB 5.0").then(|| {
        table(bytes).map_err(|problem| {
            convert(problem, "import scipy.io, numpy; m = scipy.io.loadmat('in.mat'); print(list(m))")
        })
    })
}

fn table(bytes: &[u8]) -> Result<String, String> {
    let big_endian = match bytes.get(126..HEADER) {
        Some(b"IM") => false,
        Some(b"MI") => true,
        _ => return Err("its header is incomplete or damaged".to_owned()),
    };
    let mut unpacked: Vec<Cow<'_, [u8]>> = Vec::new();
    let mut size = 0;
    let mut all = Bytes { rest: &bytes[HEADER..], big_endian };
    while !all.rest.is_empty() {
        let element = all.element().ok_or("it is incomplete: its last variable is cut off")?;
        let content = match element.kind {
            COMPRESSED => Cow::Owned(inflated(element.bytes, LARGEST - size)?),
            MATRIX => Cow::Borrowed(element.bytes),
            _ => continue,
        };
        size += content.len();
        unpacked.push(content);
    }
    let mut found = Found::default();
    for content in &unpacked {
        found.variable("", content, big_endian, 0);
    }
    let Found { arrays, fault } = found;
    side_by_side(arrays).map_err(|problem| fault.unwrap_or(problem))
}

/// Returns the content of the matrix in compressed bytes.
fn inflated(packed: &[u8], room: usize) -> Result<Vec<u8>, String> {
    let mut content = Vec::new();
    let limit = room as u64 + 1;
    let read = ZlibDecoder::new(packed).take(limit).read_to_end(&mut content);
    read.map_err(|_| "one of its variables is damaged".to_owned())?;
    if content.len() > room {
        return Err(format!("it unpacks to more than {} MB, which is the most that is read", LARGEST >> 20));
    }
    // The tag of the matrix within: its contents are all that follows.
    content.drain(..content.len().min(8));
    Ok(content)
}

impl<'a> Bytes<'a> {
    /// Takes the next element, or returns `None` if it is cut off.
    fn element(&mut self) -> Option<Element<'a>> {
        let (first, second) = (self.number(0, 4)?, self.number(4, 4)?);
        // A small element has its length in the upper half of the first number, and its bytes after it.
        let (kind, start, length, whole) = match first >> 16 {
            0 => {
                let length = usize::try_from(second).ok()?;
                let padded = if first == COMPRESSED { length } else { length.checked_next_multiple_of(8)? };
                (first, 8_usize, length, padded.checked_add(8)?)
            }
            length => (first & 0xffff, 4, usize::try_from(length).ok()?, 8),
        };
        let bytes = self.rest.get(start..start.checked_add(length)?)?;
        // The padding of the last element may be missing.
        self.rest = self.rest.get(whole..).unwrap_or(&[]);
        Some(Element { kind, bytes })
    }

    /// Returns the unsigned number in `size` bytes at an offset.
    fn number(&self, at: usize, size: usize) -> Option<u64> {
        if self.big_endian {
            let mut bytes = self.rest.get(at..at.checked_add(size)?)?.to_vec();
            bytes.reverse();
            return number_at(&bytes, 0, size);
        }
        number_at(self.rest, at, size)
    }
}

impl<'a> Found<'a> {
    /// Adds a variable, or the fields of a structure, under `name` or, if that is empty, under their names.
    fn variable(&mut self, name: &str, content: &'a [u8], big_endian: bool, depth: usize) {
        if let Err(problem) = self.parse(name, content, big_endian, depth) {
            self.fault.get_or_insert(problem);
        }
    }

    fn parse(&mut self, name: &str, content: &'a [u8], big_endian: bool, depth: usize) -> Result<(), String> {
        let damaged = || "one of its variables is damaged".to_owned();
        let mut bytes = Bytes { rest: content, big_endian };
        let inside = |element: &Element<'a>| Bytes { rest: element.bytes, big_endian };
        let flags = bytes.element().and_then(|flags| inside(&flags).number(0, 4)).ok_or_else(damaged)?;
        // Objects of newer classes have no sides.
        let sides = bytes.element().ok_or_else(damaged)?;
        let own = bytes.element().ok_or_else(damaged)?;
        let own = String::from_utf8_lossy(own.bytes).into_owned();
        let name = if name.is_empty() { own } else { name.to_owned() };
        let other = |what: &str| Err(format!("its variable `{name}` is {what}"));
        let sides: Option<Vec<usize>> =
            (0..sides.bytes.len() / 4).map(|at| inside(&sides).number(4 * at, 4)?.try_into().ok()).collect();
        let sides = sides.ok_or_else(damaged)?;
        match flags & 0xff {
            1 => return other("a cell array"),
            2 if sides.iter().any(|side| *side != 1) => return other("an array of structures"),
            2 if depth < DEEPEST => return self.structure(&name, bytes, depth).ok_or_else(damaged),
            // Text, such as a unit or a remark.
            4 => return Ok(()),
            5 => return other("a sparse matrix"),
            6..=15 if flags & 0x0800 != 0 => return other("complex"),
            6..=15 => {}
            _ => return other("an object, as tables and timeseries are, which only MATLAB reads"),
        }
        let numbers = bytes.element().ok_or_else(damaged)?;
        let code = match numbers.kind {
            1 => "i1",
            2 => "u1",
            3 => "i2",
            4 => "u2",
            5 => "i4",
            6 => "u4",
            7 => "f4",
            9 => "f8",
            12 => "i8",
            13 => "u8",
            _ => return Err(damaged()),
        };
        let code = format!("{}{code}", if big_endian { '>' } else { '<' });
        let array = Array::column_major(&code, &sides, numbers.bytes)
            .map_err(|problem| format!("of its variable `{name}`, {problem}"))?;
        self.arrays.push((name, array));
        Ok(())
    }

    /// Adds the fields of a structure from what follows its name.
    fn structure(&mut self, name: &str, mut bytes: Bytes<'a>, depth: usize) -> Option<()> {
        let big_endian = bytes.big_endian;
        let width = Bytes { rest: bytes.element()?.bytes, big_endian }.number(0, 4)?;
        let names = bytes.element()?.bytes;
        let width = usize::try_from(width).ok().filter(|width| *width > 0)?;
        for field in names.chunks_exact(width) {
            let content = bytes.element()?.bytes;
            let field = format!("{name}.{}", String::from_utf8_lossy(field).trim_end_matches('\0'));
            self.variable(&field, content, big_endian, depth + 1);
        }
        Some(())
    }
}
