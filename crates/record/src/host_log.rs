//! Reader of the `host-log` format: two header lines, then `wall clock, elapsed s, angle deg`.

use crate::error::Fault;
use crate::parsed::Parsed;
use crate::reading::{ColumnReading, Reading};
use crate::statement::Statements;
use crate::unit::Unit;

const FIELDS: usize = 3;
const DAY_S: f64 = 86_400.0;

/// Reads the text of a host log.
pub(crate) fn parse(text: &str) -> Result<Parsed, Fault> {
    let mut lines = text.lines().zip(1_u64..);
    let (header, _) = lines.next().ok_or(Fault::Empty { needed: crate::FEWEST_SAMPLES })?;
    if !is_header(header.split(',')) {
        return Err(Fault::BadHeader {
            line: 1,
            found: header.chars().take(60).collect(),
            expected: "`Timestamp, Time_Elapsed(s), Angle(deg)` as a host log has it; for a file with \
                       column names set data.format = \"csv\""
                .to_owned(),
        });
    }
    let mut parsed = Parsed::new(Unit::Degree, Statements::default(), reading());
    let mut wall = WallClock::default();
    // The second header line is a rule of dashes.
    for (content, line) in lines.skip(1).filter(|(content, _)| !content.trim().is_empty()) {
        let fields: Vec<&str> = content.split(',').collect();
        let &[wall_clock, elapsed, angle] = fields.as_slice() else {
            let found = fields.len();
            return Err(if found > FIELDS {
                Fault::ExtraFields { line, found, expected: FIELDS }
            } else {
                Fault::MissingField { line, found, expected: FIELDS }
            });
        };
        let stamp = number(elapsed, line, "Time_Elapsed(s)")?;
        let angle = number(angle, line, "Angle(deg)")?;
        wall.add(wall_clock_seconds(wall_clock, line)?, stamp);
        parsed.push(line, stamp, angle * Unit::Degree.to_si(), None)?;
    }
    parsed.findings.extend(wall.finding());
    Ok(parsed)
}

/// Returns the reading of a host log, which the format fixes.
fn reading() -> Reading {
    let column = |column: &str, unit: &str| ColumnReading {
        column: column.to_owned(),
        unit: Some(unit.to_owned()),
        because: "the format has it".to_owned(),
    };
    Reading {
        format: "host-log".to_owned(),
        separator: "comma".to_owned(),
        decimal: "point".to_owned(),
        header_line: 1,
        time: Some(column("Time_Elapsed(s)", "s")),
        value: column("Angle(deg)", "deg"),
        ..Reading::default()
    }
}

/// Parses a field as a finite number.
fn number(text: &str, line: u64, column: &str) -> Result<f64, Fault> {
    let text = text.trim();
    let number: f64 = text.parse().map_err(|_| Fault::NotANumber {
        line,
        column: column.to_owned(),
        text: text.chars().take(40).collect(),
    })?;
    if number.is_finite() { Ok(number) } else { Err(Fault::NotFinite { line, column: column.to_owned() }) }
}

/// Returns `true` if these are the columns of a host log.
pub(crate) fn is_header<'a>(names: impl Iterator<Item = &'a str>) -> bool {
    let names: Vec<String> = names.map(|name| name.trim().to_lowercase()).collect();
    matches!(names.as_slice(), [_, elapsed, angle] if elapsed.contains("elapsed") && angle.contains("angle"))
}

/// Comparison of the log's two clocks while it is read.
#[derive(Default)]
struct WallClock {
    first: Option<(f64, f64)>,
    last: Option<(f64, f64)>,
    days: f64,
}

impl WallClock {
    fn add(&mut self, seconds_of_day: f64, elapsed: f64) {
        if self.last.is_some_and(|(wall, _)| seconds_of_day + self.days < wall - DAY_S / 2.0) {
            self.days += DAY_S; // past midnight
        }
        let now = (seconds_of_day + self.days, elapsed);
        self.first.get_or_insert(now);
        self.last = Some(now);
    }

    /// Returns a sentence if the two clocks disagree on the record's length by more than 1 % plus 0.1 s. A
    /// host stamps a line when it writes it, so a delay of some tens of milliseconds is normal.
    fn finding(&self) -> Option<String> {
        let ((first_wall, first), (last_wall, last)) = (self.first?, self.last?);
        let (wall, elapsed) = (last_wall - first_wall, last - first);
        ((wall - elapsed).abs() > 0.1 + 0.01 * elapsed.abs()).then(|| {
            format!("the wall clock spans {wall:.3} s, the elapsed time {elapsed:.3} s: one of them is wrong")
        })
    }
}

/// Parses `HH:MM:SS.mmm` as seconds of the day.
fn wall_clock_seconds(text: &str, line: u64) -> Result<f64, Fault> {
    let bad = || Fault::NotANumber {
        line,
        column: "Timestamp (HH:MM:SS.mmm)".to_owned(),
        text: text.trim().chars().take(40).collect(),
    };
    let mut parts = text.trim().split(':');
    let mut next = |limit: f64| {
        parts
            .next()
            .and_then(|part| part.parse::<f64>().ok())
            .filter(|part| (0.0..limit).contains(part))
            .ok_or_else(bad)
    };
    let (hours, minutes, seconds) = (next(24.0)?, next(60.0)?, next(61.0)?);
    if parts.next().is_some() {
        return Err(bad());
    }
    Ok(hours * 3600.0 + minutes * 60.0 + seconds)
}
