//! Writing of a table as text: a header of names, then one line per sample, separated by commas.

use crate::FEWEST_SAMPLES;
use crate::dates::is_date;
use std::fmt::Write as _;

/// Content of one cell.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Cell {
    Float(f64),
    /// Written with the fewest digits that give back the same single-precision number: 0.1 and not
    /// 0.10000000149, which would be a different number in most logs.
    Single(f32),
    Integer(i128),
    Text(String),
    Missing,
}

/// A named column, whose cells are made when they are written.
pub(super) struct Column<'a> {
    pub(super) name: String,
    /// Number of cells.
    pub(super) length: usize,
    pub(super) cell: Box<dyn Fn(usize) -> Cell + 'a>,
}

/// Text of a table that is being written.
pub(super) struct Sheet {
    text: String,
    /// `true` if there are several columns.
    several: bool,
}

impl Sheet {
    /// Begins a text with remarks as comments, `# name: value`, and the header.
    pub(super) fn new(remarks: &[(String, String)], names: &[String]) -> Self {
        let one_line = |text: &str| text.replace(['\r', '\n'], " ");
        let mut text = String::new();
        for (name, value) in remarks {
            text += &format!("# {}: {}\n", one_line(name), one_line(value));
        }
        let titles: Vec<String> =
            names.iter().enumerate().map(|(at, name)| quoted(&title(name, at))).collect();
        text += &titles.join(",");
        text.push('\n');
        Self { text, several: names.len() > 1 }
    }

    /// Appends a line.
    pub(super) fn row(&mut self, cells: impl Iterator<Item = Cell>) {
        for (at, cell) in cells.enumerate() {
            if at > 0 {
                self.text.push(',');
            }
            self.cell(cell);
        }
        self.text.push('\n');
    }

    fn cell(&mut self, cell: Cell) {
        // Writing to a string cannot fail.
        let _ = match cell {
            Cell::Float(number) if number.is_finite() => write!(self.text, "{number}"),
            Cell::Single(number) if number.is_finite() => write!(self.text, "{number}"),
            Cell::Integer(number) => write!(self.text, "{number}"),
            Cell::Text(text) if !text.trim().is_empty() => write!(self.text, "{}", quoted(&text)),
            // A line without any sign would be skipped, and the samples after it would come too early.
            _ if !self.several => write!(self.text, "-"),
            _ => Ok(()),
        };
    }

    /// Returns the text.
    pub(super) fn finish(self) -> String {
        self.text
    }
}

/// Returns a name that is recognized as a column's title: with a letter, and neither a number nor a date.
fn title(name: &str, at: usize) -> String {
    let name = name.trim();
    match () {
        () if name.is_empty() => format!("column_{}", at + 1),
        () if name.parse::<f64>().is_ok() || is_date(name) || !name.contains(char::is_alphabetic) => {
            format!("column_{name}")
        }
        () => name.to_owned(),
    }
}

/// Returns a text as a cell: in quotes if it contains more than letters, digits and a few harmless signs.
fn quoted(text: &str) -> String {
    if text.chars().all(|sign| sign.is_alphanumeric() || "._-:+/^°".contains(sign)) && !text.starts_with('/')
    {
        return text.to_owned();
    }
    // The reader of tables knows no quote within quotes.
    format!("\"{}\"", text.replace('"', "'").replace(|sign: char| sign.is_control(), " "))
}

/// Writes columns side by side; a few constants beside them, as shorter columns, are left out.
///
/// # Errors
/// A clause about columns of different lengths, or that there are none.
pub(super) fn named(columns: &[Column<'_>], remarks: &[(String, String)]) -> Result<String, String> {
    let length = columns.iter().map(|column| column.length).fold(0, usize::max);
    if length == 0 {
        return Err("it holds no samples".to_owned());
    }
    let is_other = |column: &&Column<'_>| column.length != length && column.length >= FEWEST_SAMPLES;
    if let (Some(other), Some(longest)) =
        (columns.iter().find(is_other), columns.iter().find(|column| column.length == length))
    {
        return Err(format!(
            "its columns have different lengths: `{}` has {length} entries and `{}` has {}",
            longest.name, other.name, other.length
        ));
    }
    let columns: Vec<&Column<'_>> = columns.iter().filter(|column| column.length == length).collect();
    let names: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();
    let mut sheet = Sheet::new(remarks, &names);
    for row in 0..length {
        sheet.row(columns.iter().map(|column| (column.cell)(row)));
    }
    Ok(sheet.finish())
}

/// Writes a table without names. The longer side is the one of the samples. A first column that increases
/// strictly is the time, in the unit that the reader assumes; a single column is the value, without a time.
pub(super) fn unnamed(
    (rows, columns): (usize, usize),
    cell: impl Fn(usize, usize) -> Cell,
    remarks: &[(String, String)],
) -> String {
    let wide = columns > rows;
    let (rows, columns) = if wide { (columns, rows) } else { (rows, columns) };
    let cell = |row: usize, column: usize| if wide { cell(column, row) } else { cell(row, column) };
    let is_time = columns > 1 && (1..rows).all(|row| increases(&cell(row - 1, 0), &cell(row, 0)));
    let name = |at: usize| match at {
        0 if columns == 1 => "value".to_owned(),
        0 if is_time => "time".to_owned(),
        _ => format!("column_{}", at + 1),
    };
    let mut sheet = Sheet::new(remarks, &(0..columns).map(name).collect::<Vec<_>>());
    for row in 0..rows {
        sheet.row((0..columns).map(|column| cell(row, column)));
    }
    sheet.finish()
}

fn increases(one: &Cell, next: &Cell) -> bool {
    match (one, next) {
        (Cell::Integer(one), Cell::Integer(next)) => one < next,
        (Cell::Single(one), Cell::Single(next)) => one < next,
        _ => number(one).zip(number(next)).is_some_and(|(one, next)| one < next),
    }
}

fn number(cell: &Cell) -> Option<f64> {
    match cell {
        Cell::Float(number) => Some(*number),
        Cell::Single(number) => Some(f64::from(*number)),
        Cell::Integer(number) => Some(*number as f64),
        Cell::Text(_) | Cell::Missing => None,
    }
}
