//! Reader of NumPy's array files (`.npy`), versions 1 to 3.
//!
//! Source: NumPy Enhancement Proposal 1, *A Simple File Format for NumPy Arrays*, and the documentation of
//! `numpy.lib.format`; for type codes, that of NumPy's array interface.

#![allow(clippy::indexing_slicing, reason = "the header was read")]

use super::bytes::{length_at, number_at};
use super::literal::Literal;
use super::sheet::{Cell, Column, named, unnamed};
use super::unread::Unread;

const MAGIC: &[u8] = b"\x93NUMPY";

/// An array whose numbers stay where they are in the file.
pub(super) struct Array<'a> {
    /// Fields of an element: one without a name, or those of a structured array.
    fields: Vec<Field>,
    /// Number of bytes of an element.
    size: usize,
    /// Lengths of the sides that are longer than one element.
    shape: Vec<usize>,
    /// `true` if the first index varies fastest.
    fortran: bool,
    data: &'a [u8],
}

/// A field of an element.
#[derive(Clone)]
struct Field {
    name: String,
    /// Unit of a time, as a title ends with it: ` [ms]`.
    unit: String,
    kind: Kind,
    /// `true` if the highest byte comes first.
    big_endian: bool,
    /// Offset in the element, in bytes.
    at: usize,
    /// Number of bytes of one number or text.
    size: usize,
    /// Number of these, one after another.
    count: usize,
}

/// Kind of a number or text.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Truth,
    Signed,
    /// Signed, with the lowest number for no time.
    Time,
    Unsigned,
    Float,
    Bytes,
    Unicode,
}

/// Returns the table of an array file.
pub(super) fn text(bytes: &[u8]) -> Option<Result<String, Unread>> {
    bytes.starts_with(MAGIC).then(|| {
        let read = || {
            let array = Array::parse(bytes)?;
            if array.is_nameless() { Ok(array.table(&[])) } else { named(&array.columns(""), &[]) }
        };
        read().map_err(|problem| Unread {
            kind: "a NumPy array (.npy)",
            problem,
            remedy: "write a table of numbers, in Python with\n    \
                     import numpy; table = numpy.load('in.npy', allow_pickle=True)  # make it two-dimensional\n    \
                     numpy.savetxt('out.csv', table, delimiter=',', header='time_s,angle_rad', comments='')"
                .to_owned(),
        })
    })
}

impl<'a> Array<'a> {
    /// Parses an array file.
    ///
    /// # Errors
    /// A clause about what is wrong.
    pub(super) fn parse(bytes: &'a [u8]) -> Result<Self, String> {
        let incomplete = || "its header is incomplete or damaged".to_owned();
        let major = bytes.get(MAGIC.len()).copied().ok_or_else(incomplete)?;
        let width = match major {
            1 => 2,
            2 | 3 => 4,
            _ => return Err(format!("its version {major} is newer than the known ones, 1 to 3")),
        };
        let start = MAGIC.len() + 2 + width;
        let length = length_at(bytes, MAGIC.len() + 2, width).ok_or_else(incomplete)?;
        let header =
            start.checked_add(length).and_then(|end| bytes.get(start..end)).ok_or_else(incomplete)?;
        // Version 3 is UTF-8 and the others Latin-1; both are ASCII unless a field's name is not.
        let header = String::from_utf8_lossy(header);
        let header = Literal::parse(&header).ok_or_else(incomplete)?;
        let shape = header.get("shape").and_then(Literal::numbers).ok_or_else(incomplete)?;
        let (fields, size) = fields(header.get("descr").ok_or_else(incomplete)?)?;
        let data = &bytes[start + length..];
        let fortran = header.get("fortran_order") == Some(&Literal::Truth(true));
        Self::checked(fields, size, &shape, fortran, data)
    }

    /// Checks that all numbers are there, and that they are a table.
    fn checked(
        fields: Vec<Field>,
        size: usize,
        sides: &[usize],
        fortran: bool,
        data: &'a [u8],
    ) -> Result<Self, String> {
        match sides.iter().try_fold(size, |product, side| product.checked_mul(*side)) {
            Some(0) => return Err("it is empty".to_owned()),
            Some(needed) if needed <= data.len() => {}
            _ => return Err("it is cut off: its header announces more numbers than it holds".to_owned()),
        }
        let shape: Vec<usize> = sides.iter().copied().filter(|side| *side != 1).collect();
        let fields = fields.into_iter().flat_map(expanded).collect();
        match shape.len() {
            0..=2 => Ok(Self { fields, size, shape, fortran, data }),
            sides => Err(format!("it has {sides} dimensions and a table has two")),
        }
    }

    /// Makes an array of plain numbers out of their type's code, as in [`Field::parse`], the lengths of the sides,
    /// of which the first varies fastest, and the numbers' bytes.
    ///
    /// # Errors
    /// As [`Array::parse`].
    pub(super) fn column_major(code: &str, sides: &[usize], data: &'a [u8]) -> Result<Self, String> {
        let field = Field::parse("", code, 0, 1)?;
        let size = field.size;
        Self::checked(vec![field], size, sides, true, data)
    }

    /// Returns `true` if the elements have no fields with names.
    pub(super) fn is_nameless(&self) -> bool {
        self.fields.iter().all(|field| field.name.is_empty())
    }

    /// Returns the number of samples: the longer side.
    fn length(&self) -> usize {
        // An array without sides is a single number.
        self.shape.iter().copied().max().unwrap_or(1)
    }

    /// Returns the text of a table without names.
    pub(super) fn table(&self, remarks: &[(String, String)]) -> String {
        unnamed(self.sides(), |row, column| self.cell(self.place(row, column), 0), remarks)
    }

    /// Returns `true` if there are rows and columns.
    pub(super) fn has_two_sides(&self) -> bool {
        self.shape.len() == 2
    }

    fn sides(&self) -> (usize, usize) {
        match self.shape.as_slice() {
            [rows, columns, ..] => (*rows, *columns),
            _ => (self.length(), 1),
        }
    }

    /// Returns the number of the element at a row and a column.
    fn place(&self, row: usize, column: usize) -> usize {
        let (rows, columns) = self.sides();
        if self.fortran { column * rows + row } else { row * columns + column }
    }

    /// Returns the only number or text of an array without sides.
    pub(super) fn single(&self) -> Option<Cell> {
        (self.shape.is_empty() && self.fields.len() == 1).then(|| self.cell(0, 0))
    }

    /// Returns the columns, named by the array, its fields, and numbers if several have one name.
    pub(super) fn columns<'b>(&'b self, name: &str) -> Vec<Column<'b>> {
        let (rows, columns) = self.sides();
        let wide = columns > rows;
        let count = if wide { rows } else { columns };
        let mut found = Vec::new();
        for (number, field) in self.fields.iter().enumerate() {
            for column in 0..count {
                let parts = [name, field.name.as_str()];
                let mut title =
                    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(".");
                if count > 1 {
                    title += &format!("_{}", column + 1);
                }
                title += &field.unit;
                let place = move |row| if wide { self.place(column, row) } else { self.place(row, column) };
                found.push(Column {
                    name: title,
                    length: self.length(),
                    cell: Box::new(move |row| self.cell(place(row), number)),
                });
            }
        }
        found
    }

    fn cell(&self, element: usize, field: usize) -> Cell {
        let read = || {
            let field = self.fields.get(field)?;
            let at = element.checked_mul(self.size)?.checked_add(field.at)?;
            Some(field.read(self.data.get(at..at.checked_add(field.size)?)?))
        };
        // The size was compared with the file's length: no element is missing.
        read().unwrap_or(Cell::Missing)
    }
}

/// Returns the fields of a type with the number of bytes of an element.
fn fields(description: &Literal) -> Result<(Vec<Field>, usize), String> {
    let items = match description {
        Literal::Text(code) => {
            let field = Field::parse("", code, 0, 1)?;
            let size = field.size;
            return Ok((vec![field], size));
        }
        Literal::Sequence(items) => items,
        _ => return Err("the type of its numbers is unknown".to_owned()),
    };
    let (mut fields, mut at) = (Vec::new(), 0_usize);
    for item in items {
        let (name, code, count) = parts(item)?;
        let too_large = || format!("its field `{name}` is too large");
        let size = if let Some(bytes) = code.strip_prefix("|V") {
            // Bytes without a meaning, between fields.
            bytes.parse().map_err(|_| too_large())?
        } else {
            let field = Field::parse(name, code, at, count)?;
            let size = field.size;
            fields.push(field);
            size
        };
        at = size.checked_mul(count).and_then(|size| at.checked_add(size)).ok_or_else(too_large)?;
    }
    Ok((fields, at))
}

/// Returns the name, the code and the count of a structured type's field.
fn parts(item: &Literal) -> Result<(&str, &str, usize), String> {
    let nested = || "its fields have fields of their own".to_owned();
    let Literal::Sequence(parts) = item else { return Err(nested()) };
    let (name, code, sides) = match parts.as_slice() {
        [name, Literal::Text(code)] => (name, code, Vec::new()),
        [name, Literal::Text(code), shape] => (name, code, shape.numbers().ok_or_else(nested)?),
        _ => return Err(nested()),
    };
    let name = match name {
        Literal::Text(name) => Some(name),
        // A title before the name.
        Literal::Sequence(names) => match names.as_slice() {
            [_, Literal::Text(name)] => Some(name),
            _ => None,
        },
        _ => None,
    };
    let count = sides.iter().try_fold(1_usize, |product, side| product.checked_mul(*side));
    Ok((name.ok_or_else(nested)?, code, count.ok_or_else(nested)?))
}

/// Returns the fields of one number each.
fn expanded(field: Field) -> impl Iterator<Item = Field> {
    (0..field.count).map(move |number| {
        let mut one = field.clone();
        one.at += number * field.size;
        if field.count > 1 {
            one.name += &format!("_{}", number + 1);
        }
        one
    })
}

impl Field {
    /// Parses a type's code: byte order, kind, number of bytes, and for times a unit: `<f8`, `|u1`, `<M8[us]`.
    fn parse(name: &str, code: &str, at: usize, count: usize) -> Result<Self, String> {
        let other = || format!("its numbers are of the type `{code:.20}`");
        let (order, rest) = match code.chars().next() {
            Some(order @ ('<' | '>' | '|' | '=')) => (order, code.get(1..).ok_or_else(other)?),
            _ => ('=', code),
        };
        let (letter, rest) = rest.split_at_checked(1).ok_or_else(other)?;
        match letter {
            "O" => return Err("it holds Python objects".to_owned()),
            "c" => return Err("its numbers are complex".to_owned()),
            _ => {}
        }
        // Only times have a unit, in brackets.
        let (digits, unit) = rest.split_once('[').unwrap_or((rest, ""));
        let width: usize = digits.parse().map_err(|_| other())?;
        let unit = unit.trim_end_matches(']');
        let (kind, size) = match (letter, width) {
            ("f", size @ (2 | 4 | 8)) => (Kind::Float, size),
            ("i", size @ (1 | 2 | 4 | 8)) => (Kind::Signed, size),
            ("u", size @ (1 | 2 | 4 | 8)) => (Kind::Unsigned, size),
            ("b", 1) => (Kind::Truth, 1),
            ("M" | "m", 8) if matches!(unit, "s" | "ms" | "us" | "ns") => (Kind::Time, 8),
            ("S", size @ 1..) => (Kind::Bytes, size),
            ("U", signs @ 1..) => (Kind::Unicode, signs.checked_mul(4).ok_or_else(other)?),
            _ => return Err(other()),
        };
        let unit = if kind == Kind::Time { format!(" [{unit}]") } else { String::new() };
        let name = name.to_owned();
        Ok(Self { name, unit, kind, big_endian: order == '>', at, size, count })
    }

    /// Reads the field from its bytes.
    fn read(&self, bytes: &[u8]) -> Cell {
        match self.kind {
            Kind::Bytes => {
                let text: String = bytes.iter().map(|byte| char::from(*byte)).collect();
                return Cell::Text(text.trim_end_matches('\0').to_owned());
            }
            Kind::Unicode => {
                let sign = |bytes: &[u8]| char::from_u32(u32::try_from(self.number(bytes)?).ok()?);
                let text: String = bytes.chunks_exact(4).filter_map(sign).collect();
                return Cell::Text(text.trim_end_matches('\0').to_owned());
            }
            _ => {}
        }
        let Some(number) = self.number(bytes) else { return Cell::Missing };
        let unused = 64 - 8 * bytes.len();
        // The casts below keep all bits: the lengths are those of the types.
        let signed = ((number << unused) as i64) >> unused;
        match (self.kind, bytes.len()) {
            (Kind::Time, _) if signed == i64::MIN => Cell::Missing,
            (Kind::Signed | Kind::Time, _) => Cell::Integer(signed.into()),
            (Kind::Float, 2) => Cell::Single(half(number as u16)),
            (Kind::Float, 4) => Cell::Single(f32::from_bits(number as u32)),
            (Kind::Float, _) => Cell::Float(f64::from_bits(number)),
            _ => Cell::Integer(number.into()),
        }
    }

    /// Returns the bits of one to eight bytes, in the byte order of the field.
    fn number(&self, bytes: &[u8]) -> Option<u64> {
        let mut ordered = [0; 8];
        let part = ordered.get_mut(..bytes.len())?;
        part.copy_from_slice(bytes);
        if self.big_endian {
            part.reverse();
        }
        number_at(&ordered, 0, ordered.len())
    }
}

/// Returns a number of half precision (IEEE 754 binary16).
fn half(bits: u16) -> f32 {
    let (exponent, fraction) = (i32::from(bits >> 10) & 31, f32::from(bits & 1023));
    let size = match exponent {
        0 => fraction * 2_f32.powi(-24),
        31 if fraction == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        _ => (1024.0 + fraction) * 2_f32.powi(exponent - 25),
    };
    if bits >> 15 == 1 { -size } else { size }
}
