//! The `csv` format: a header with column names, then numbers.

use crate::error::Fault;
use crate::file::Parsed;
use crate::header::misread;
use crate::statement::Statements;
use crate::unit::{TimeUnit, Unit};

/// Which columns to read. Names left open are looked for under the usual ones.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CsvColumns {
    /// The time column. Usual names: `time_s`, `time`, `t`.
    pub time: Option<String>,
    /// The observed column. Usual names: `angle_rad`, `angle`, `angle_deg`.
    pub angle: Option<String>,
    /// The measured input. Usual name: `torque_nm`; absent where there is none.
    pub input: Option<String>,
    /// Unit of the observed column; left open, it is what the column's name says, else radian.
    pub unit: Option<Unit>,
    /// Unit of the time column.
    pub time_unit: TimeUnit,
    /// Rate at which to lay out a file without a time column, in hertz; a statement to be checked where there is one.
    pub sample_rate_hz: Option<f64>,
}

const TIME_NAMES: &[&str] = &["time_s", "time", "t"];
const ANGLE_NAMES: &[&str] = &["angle_rad", "angle", "angle_deg"];
const INPUT_NAMES: &[&str] = &["torque_nm"];

/// Reads the text of a CSV file.
pub(crate) fn parse(text: &str, columns: &CsvColumns) -> Result<Parsed, Fault> {
    let mut statements = Statements::default();
    for comment in text.lines().filter_map(|line| line.trim_start().strip_prefix('#')) {
        statements.read_comment(comment);
    }
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(text.as_bytes());
    let unreadable = |error: csv::Error| Fault::Unreadable { problem: error.to_string() };
    let header = reader.headers().map_err(unreadable)?.clone();
    // The reader's own position lies before comments and empty lines.
    let is_header = |line: &str| !line.is_empty() && !line.starts_with('#');
    let line = text.lines().zip(1..).find(|(line, _)| is_header(line)).map_or(1, |(_, line)| line);
    if header.is_empty() {
        return Err(Fault::Empty { needed: crate::FEWEST_SAMPLES });
    }
    let find = |wanted: Option<&str>, usual: &[&str], key: &'static str| {
        let candidates = wanted.map_or_else(|| usual.to_vec(), |name| vec![name]);
        candidates.iter().find_map(|name| header.iter().position(|title| title == *name)).ok_or_else(|| {
            misread(text, &header, line).unwrap_or_else(|| Fault::MissingColumn {
                line,
                wanted: candidates.join("` or `"),
                found: header.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
                key,
            })
        })
    };
    let time = match (find(columns.time.as_deref(), TIME_NAMES, "data.time"), columns.sample_rate_hz) {
        // Stamps are measured and a rate is said: where they differ, that is told.
        (Ok(at), rate) => {
            statements.sample_rate_hz = rate.or(statements.sample_rate_hz);
            TimeColumn::At(at)
        }
        (Err(_), Some(rate)) if columns.time.is_none() => TimeColumn::Rate(rate),
        (Err(fault), _) => return Err(fault),
    };
    let angle = find(columns.angle.as_deref(), ANGLE_NAMES, "data.angle")?;
    let input = match columns.input.as_deref() {
        Some(name) => Some(find(Some(name), INPUT_NAMES, "data.input")?),
        None => find(None, INPUT_NAMES, "data.input").ok(),
    };
    let title = |at: usize| header.get(at).unwrap_or_default();
    let unit = columns.unit.unwrap_or(match title(angle) {
        "angle_deg" => Unit::Degree,
        _ => Unit::Radian,
    });
    let needed = [Some(angle), input, time.index()].into_iter().flatten().max().unwrap_or(0) + 1;

    let mut parsed = Parsed::new(unit, statements);
    let mut row = csv::StringRecord::new();
    while reader.read_record(&mut row).map_err(unreadable)? {
        let line = row.position().map_or(0, csv::Position::line);
        if row.len() < needed {
            return Err(Fault::MissingField { line, found: row.len(), expected: header.len() });
        }
        if row.iter().skip(header.len()).any(|field| !field.is_empty()) {
            return Err(Fault::ExtraFields { line, found: row.len(), expected: header.len() });
        }
        let number = |at: usize| number(row.get(at).unwrap_or_default(), line, title(at));
        let stamp = match time {
            TimeColumn::At(at) => columns.time_unit.to_seconds(number(at)?),
            TimeColumn::Rate(rate) => parsed.len() as f64 / rate,
        };
        parsed.push(line, stamp, number(angle)? * unit.to_si())?;
        if let Some(at) = input {
            parsed.push_input(number(at)?);
        }
    }
    Ok(parsed)
}

/// Where the stamps come from.
enum TimeColumn {
    At(usize),
    Rate(f64),
}

impl TimeColumn {
    fn index(&self) -> Option<usize> {
        match self {
            Self::At(at) => Some(*at),
            Self::Rate(_) => None,
        }
    }
}

/// A field as a finite number.
pub(crate) fn number(text: &str, line: u64, column: &str) -> Result<f64, Fault> {
    let text = text.trim();
    let number: f64 = text.parse().map_err(|_| Fault::NotANumber {
        line,
        column: column.to_owned(),
        text: text.chars().take(40).collect(),
    })?;
    if number.is_finite() { Ok(number) } else { Err(Fault::NotFinite { line, column: column.to_owned() }) }
}
