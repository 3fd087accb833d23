//! Dates and times of day as programs write them.

use jiff::Timestamp;
use jiff::civil::{DateTime, Time};
use jiff::tz::TimeZone;

/// Order of day and month in dates that end with the year: `06/14/2023`. Between dots the day is the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct DateOrder {
    is_day_first: bool,
    /// `true` if no date of the column tells the order.
    pub(crate) is_assumed: bool,
}

impl DateOrder {
    /// Determines the order by a field above 12; without one it is month first, as in the United States.
    pub(crate) fn of<'a>(cells: impl Iterator<Item = &'a str>) -> Self {
        let mut found = Self::default();
        for cell in cells {
            let Some(('/' | '-', [one, two, _])) = fields(day_and_clock(cell).0) else { continue };
            found = match (one, two) {
                // With the year first there is nothing to tell.
                (32.., _) => continue,
                (13.., _) => return Self { is_day_first: true, is_assumed: false },
                (_, 13..) => return Self::default(),
                _ => Self { is_day_first: false, is_assumed: true },
            };
        }
        found
    }
}

/// Returns `true` if a cell is a date or a time of day.
pub(crate) fn is_date(text: &str) -> bool {
    let (text, _) = without_half(text);
    let digits = text.chars().filter(char::is_ascii_digit).count();
    let colons = text.matches(':').count();
    text.starts_with(|sign: char| sign.is_ascii_digit())
        && digits >= 4
        && (colons >= 1 || text.matches('-').count() == 2)
        && text.chars().all(|sign| sign.is_ascii_digit() || " :-+.,TtZz[]/".contains(sign))
}

/// Parses a date, with or without an offset, or a time of day, in nanoseconds: ISO 8601, also with a blank in
/// place of the T, or day, month and year in another order, and hours of half a day with AM or PM.
pub(crate) fn nanoseconds(text: &str, order: DateOrder) -> Option<i128> {
    let text = text.replace(',', ".");
    let (text, half) = without_half(&text);
    let (day, clock) = day_and_clock(text);
    let clock = clock.map(|clock| of_whole_day(clock, half));
    let Some(day) = day else {
        let time: Time = clock??.parse().ok()?;
        let seconds =
            i128::from(time.hour()) * 3600 + i128::from(time.minute()) * 60 + i128::from(time.second());
        return Some(seconds * 1_000_000_000 + i128::from(time.subsec_nanosecond()));
    };
    let (sign, [one, two, three]) = fields(Some(day))?;
    let (year, month, day) = match sign {
        _ if one > 31 => (one, two, three),
        '/' | '-' if !order.is_day_first => (three, one, two),
        _ => (three, two, one),
    };
    let year = if year < 100 { 2000 + year } else { year };
    let clock = clock.map_or(Some("00:00".to_owned()), |clock| clock)?;
    let text = format!("{year:04}-{month:02}-{day:02}T{clock}");
    if let Ok(stamp) = text.parse::<Timestamp>() {
        return Some(stamp.as_nanosecond());
    }
    let date: DateTime = text.parse().ok()?;
    Some(date.to_zoned(TimeZone::UTC).ok()?.timestamp().as_nanosecond())
}

/// Splits a text into its day and its time of the day.
fn day_and_clock(text: &str) -> (Option<&str>, Option<&str>) {
    let text = text.trim();
    match text.split_once([' ', 'T', 't']) {
        Some((day, clock)) => (Some(day), Some(clock)),
        None if text.contains(':') => (None, Some(text)),
        None => (Some(text), None),
    }
}

/// Returns the three numbers of a day with the sign between them.
fn fields(day: Option<&str>) -> Option<(char, [u16; 3])> {
    let day = day?;
    let sign = day.chars().find(|sign| !sign.is_ascii_digit())?;
    let numbers: Option<Vec<u16>> = day.split(sign).map(|field| field.parse().ok()).collect();
    Some((sign, numbers?.try_into().ok()?))
}

/// Splits off AM or PM; returns the hours to add after twelve o'clock.
fn without_half(text: &str) -> (&str, Option<u8>) {
    let found = [("AM", 0), ("PM", 12)].into_iter().find_map(|(word, hours)| {
        let (before, end) = text.split_at_checked(text.len().checked_sub(word.len())?)?;
        end.eq_ignore_ascii_case(word).then_some((before.trim_end(), Some(hours)))
    });
    found.unwrap_or((text, None))
}

/// Returns a time of the day with two digits of hours, out of 24.
fn of_whole_day(clock: &str, half: Option<u8>) -> Option<String> {
    let (hour, rest) = clock.trim_start().split_once(':')?;
    let hour: u8 = hour.parse().ok()?;
    let hour = half.map_or(hour, |hours| hour % 12 + hours);
    Some(format!("{hour:02}:{}", rest.replace(' ', "")))
}
