//! Reader of LabVIEW measurement files (`.lvm`).
//!
//! Source: National Instruments, *Specification for the LabVIEW Measurement File (.lvm)*, version 2.0.

use super::sheet::{Cell, Sheet};
use super::unread::Unread;
use crate::dialect::is_missing;
use jiff::civil::Date;

/// Title of a column of times, which stands before the columns that belong to it.
const X: &str = "X_Value";

/// Samples below one header.
#[derive(Default)]
struct Segment<'a> {
    /// Lines of the header: a tag, then the value of each channel under that channel's title.
    tags: Vec<Vec<&'a str>>,
    titles: Vec<&'a str>,
    /// `true` if there are columns of times, which stand before those of their channels.
    timed: bool,
    /// `true` if commas separate cells and are no decimal signs.
    commas: bool,
    rows: Vec<Vec<&'a str>>,
}

/// Time of a channel's samples.
#[derive(Clone, Copy, PartialEq)]
enum Times {
    /// A column, in seconds.
    Column(usize),
    /// The time of the first sample and the step, in seconds.
    Even(f64, f64),
}

/// A channel: its column and its time.
type Channel = (usize, Times);

/// Returns the table of a LabVIEW measurement file: the time, in seconds, and the channels; if channels have
/// times of their own, each with its time before it. Segments are joined while their time goes on.
pub(super) fn text(text: &str) -> Option<Result<String, Unread>> {
    text.starts_with("LabVIEW Measurement").then(|| {
        read(text).map_err(|problem| Unread {
            kind: "a LabVIEW measurement file",
            problem,
            remedy: "write it again from LabVIEW, with the signal over time and one header".to_owned(),
        })
    })
}

fn read(text: &str) -> Result<String, String> {
    let segments = segments(text);
    let first = segments.first().ok_or("it holds no line of titles, which begins with X_Value")?;
    let dimension = first.tag("X_Dimension", 1);
    if let Some(other) = dimension.filter(|name| !name.eq_ignore_ascii_case("time")) {
        return Err(format!("its samples are over `{other}` and not over time"));
    }
    let first_channels = first.channels()?;
    let times = first_channels.first().map(|(_, times)| *times);
    let shared = first_channels.iter().all(|(_, own)| Some(*own) == times);
    let mut names = Vec::new();
    for (number, (at, _)) in first_channels.iter().enumerate() {
        if number == 0 || !shared {
            names.push("time_s".to_owned());
        }
        names.push(first.name(*at));
    }
    let mut sheet = Sheet::new(&[], &names);
    let mut last = f64::NEG_INFINITY;
    for segment in &segments {
        // A later segment that is cut off or has other channels ends the table.
        let Ok(channels) = segment.channels() else { break };
        let offset = [Some(0.0), segment.since(first)].into_iter().flatten().find(|offset| {
            let start = channels.first().and_then(|(_, times)| segment.time(*times, 0));
            start.is_none_or(|start| start + offset > last)
        });
        let alike = segment.titles == first.titles && channels.len() == first_channels.len();
        let Some(offset) = offset.filter(|_| alike) else { break };
        for row in 0..segment.rows.len() {
            // A line without a time leaves the last one as it is.
            let time = channels.first().and_then(|(_, times)| segment.time(*times, row));
            last = time.map_or(last, |time| time + offset);
            sheet.row(segment.cells(&channels, shared, row, offset).into_iter());
        }
    }
    Ok(sheet.finish())
}

/// Splits a file into its segments.
fn segments(text: &str) -> Vec<Segment<'_>> {
    let states = |tag: &str, value: &str| {
        let mut lines =
            text.lines().take_while(|line| !is_end(line)).filter_map(|line| line.strip_prefix(tag));
        lines.any(|rest| rest.trim_matches([',', '\t', ' ']) == value)
    };
    let (commas, timed) = (states("Separator", "Comma"), !states("X_Columns", "No"));
    let separator = if commas { ',' } else { '\t' };
    let body = text.lines().skip_while(|line| !is_end(line)).skip(1);
    let new = || Segment { timed, commas, ..Segment::default() };
    let (mut found, mut open, mut special) = (Vec::new(), new(), false);
    for cells in body.map(|line| line.split(separator).map(str::trim).collect::<Vec<&str>>()) {
        let first = cells.first().copied().unwrap_or("");
        special = (special || first == "***Start_Special***") && first != "***End_Special***";
        if special || first.starts_with("***") || cells.iter().all(|cell| cell.is_empty()) {
            continue;
        }
        if !open.titles.is_empty() && (first.is_empty() || open.number(first).is_some()) {
            open.rows.push(cells);
            continue;
        }
        if !open.titles.is_empty() {
            found.push(std::mem::replace(&mut open, new()));
        }
        if first == X {
            open.titles = cells;
        } else {
            open.tags.push(cells);
        }
    }
    found.push(open);
    found.retain(|segment| !segment.titles.is_empty());
    found
}

fn is_end(line: &str) -> bool {
    line.starts_with("***End_of_Header***")
}

impl<'a> Segment<'a> {
    /// Parses a number. A comma is a decimal sign wherever it is no separator, also in files of older
    /// versions, which do not state the sign.
    fn number(&self, cell: &str) -> Option<f64> {
        if self.commas { cell.parse().ok() } else { cell.replacen(',', ".", 1).parse().ok() }
    }

    /// Returns a cell of the header: a tag's value, for a channel at the column of its title.
    fn tag(&self, name: &str, at: usize) -> Option<&'a str> {
        let tag = self.tags.iter().find(|tag| tag.first() == Some(&name))?;
        tag.get(at).copied().filter(|value| !value.is_empty())
    }

    /// Returns the channels.
    ///
    /// # Errors
    /// A clause if there is none, or one has no time.
    fn channels(&self) -> Result<Vec<Channel>, String> {
        let stated = self.tag("Channels", 1).and_then(|count| count.parse::<usize>().ok());
        // The last title is that of the comments.
        let count = stated.unwrap_or(self.titles.len().saturating_sub(2));
        let is_channel = |(_, title): &(usize, &&str)| **title != X;
        let found = self.titles.iter().enumerate().filter(is_channel).take(count).map(|(at, _)| at);
        let mut channels = Vec::new();
        for at in found {
            let own = at.checked_sub(1).filter(|before| self.titles.get(*before) == Some(&X));
            let times = if self.timed {
                // The first title is that of the times if a channel has no time of its own.
                Times::Column(own.unwrap_or(0))
            } else {
                // The specification's default for the first sample is zero.
                let start = self.tag("X0", at).and_then(|cell| self.number(cell)).unwrap_or(0.0);
                let step = self.tag("Delta_X", at).and_then(|cell| self.number(cell));
                let step = step.filter(|step| step.is_finite() && *step > 0.0);
                Times::Even(start, step.ok_or("it has neither a time column nor a step, Delta_X")?)
            };
            channels.push((at, times));
        }
        if channels.is_empty() { Err("it holds no channel".to_owned()) } else { Ok(channels) }
    }

    /// Returns the name of a channel, with its unit if the name does not state one.
    fn name(&self, at: usize) -> String {
        let title = self.titles.get(at).copied().unwrap_or("");
        match self.tag("Y_Unit_Label", at) {
            Some(unit) if !title.contains(unit) => format!("{title} [{unit}]"),
            _ => title.to_owned(),
        }
    }

    /// Returns the time of a row, in seconds from the origin of the segment.
    fn time(&self, times: Times, row: usize) -> Option<f64> {
        match times {
            Times::Even(start, step) => Some(start + row as f64 * step),
            Times::Column(at) => self.number(self.rows.get(row)?.get(at)?),
        }
    }

    /// Returns the cells of a row: the times, moved by an offset in seconds, and the values.
    fn cells(&self, channels: &[Channel], shared: bool, row: usize, offset: f64) -> Vec<Cell> {
        let mut cells = Vec::new();
        for (number, (at, times)) in channels.iter().enumerate() {
            if number == 0 || !shared {
                let time = self.time(*times, row);
                cells.push(time.map_or(Cell::Missing, |time| Cell::Float(time + offset)));
            }
            // A row that ends before the channel has an empty cell there.
            let text = self.rows.get(row).and_then(|row| row.get(*at)).copied().unwrap_or("");
            cells.push(match self.number(text) {
                Some(number) => Cell::Float(number),
                None if is_missing(text) => Cell::Missing,
                None => Cell::Text(text.to_owned()),
            });
        }
        cells
    }

    /// Returns the time from the beginning of another segment to that of this one by their dates, in seconds.
    fn since(&self, other: &Self) -> Option<f64> {
        let ((day, second), (other_day, other_second)) = (self.start()?, other.start()?);
        Some(day.duration_since(other_day).as_secs_f64() + (second - other_second))
    }

    /// Returns the beginning of the segment: its day, and the time of the day in seconds.
    fn start(&self) -> Option<(Date, f64)> {
        let mut parts = self.tag("Date", 1)?.split('/');
        let mut part = || parts.next();
        let day = Date::new(part()?.parse().ok()?, part()?.parse().ok()?, part()?.parse().ok()?).ok()?;
        let seconds = self.tag("Time", 1)?.split(':').try_fold(0.0, |sum, part| {
            let number: f64 = part.replacen(',', ".", 1).parse().ok()?;
            Some(60.0 * sum + number)
        })?;
        Some((day, seconds))
    }
}
