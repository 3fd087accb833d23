//! Conversion of a file's time column to stamps in seconds.

use crate::dates::{DateOrder, is_date, nanoseconds};
use crate::dialect::Dialect;
use crate::statistics::upper_median;
use crate::unit::TimeUnit;

/// A stamp as written: whole units and a fraction, so that nanoseconds since 1970 keep their differences.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stamp {
    whole: i128,
    fraction: f64,
}

const DAY_NS: i128 = 86_400_000_000_000;

/// Largest first stamp, in seconds, that is kept as written: eleven days since a start.
const LARGEST_KEPT_S: f64 = 1e6;

impl Stamp {
    /// Parses a cell; dates and times of day are in nanoseconds.
    pub(crate) fn parse(text: &str, dialect: Dialect, order: DateOrder) -> Option<Self> {
        if is_date(text) {
            return nanoseconds(text, order).map(|whole| Self { whole, fraction: 0.0 });
        }
        let value = dialect.number(text)?;
        let point = if dialect.decimal_comma { ',' } else { '.' };
        let (whole, fraction) = text.split_once(point).unwrap_or((text, ""));
        // With an exponent, or beyond 128 bits, only the double is available.
        let exact = whole.parse::<i128>().ok().filter(|_| fraction.bytes().all(|byte| byte.is_ascii_digit()));
        let Some(exact) = exact.filter(|_| value.abs() >= 1e6) else {
            return Some(Self { whole: 0, fraction: value });
        };
        let part: f64 = format!("0.{fraction}0").parse().ok()?;
        Some(Self { whole: exact, fraction: if value < 0.0 { -part } else { part } })
    }

    pub(crate) fn value(self) -> f64 {
        self.whole as f64 + self.fraction
    }

    fn since(self, first: Self) -> f64 {
        (self.whole - first.whole) as f64 + (self.fraction - first.fraction)
    }

    /// Combines seconds and nanoseconds, as ROS stores them.
    pub(crate) fn with_nanoseconds(self, nanoseconds: Self) -> Self {
        let whole = (self.value() as i128).saturating_mul(1_000_000_000);
        Self { whole: whole.saturating_add(nanoseconds.value() as i128), fraction: 0.0 }
    }
}

/// Stamps in seconds, their original unit, and how that unit was determined.
pub(crate) struct Times {
    pub(crate) seconds: Vec<f64>,
    pub(crate) unit: TimeUnit,
    pub(crate) told: Told,
    /// `true` if stamps are counted from the first.
    pub(crate) from_first: bool,
}

/// Source of the unit of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Told {
    Stated,
    Magnitude,
    /// Whole numbers with steps of at least two.
    Whole,
    Assumed,
}

/// Converts stamps to seconds: elapsed times as written, dates and times since 1970 counted from the first.
pub(crate) fn seconds(stamps: &[Stamp], stated: Option<TimeUnit>, dates: bool) -> Times {
    let first = stamps.first().copied().unwrap_or(Stamp { whole: 0, fraction: 0.0 });
    if dates {
        // A time of day starts again after midnight.
        let (mut days, mut previous) = (0, first.whole);
        let of_day = stamps.iter().all(|stamp| (0..DAY_NS).contains(&stamp.whole));
        let seconds = stamps.iter().map(|stamp| {
            if of_day && stamp.whole + days < previous - DAY_NS / 2 {
                days += DAY_NS;
            }
            previous = stamp.whole + days;
            (previous - first.whole) as f64 / 1e9
        });
        return Times {
            seconds: seconds.collect(),
            unit: TimeUnit::Iso,
            told: Told::Stated,
            from_first: true,
        };
    }
    let (unit, told) = match stated.filter(|unit| *unit != TimeUnit::Iso) {
        Some(unit) => (unit, Told::Stated),
        None => match (since_1970(first.value()), whole_steps(stamps)) {
            (Some(unit), _) => (unit, Told::Magnitude),
            (None, Some(unit)) => (unit, Told::Whole),
            (None, None) => (TimeUnit::Second, Told::Assumed),
        },
    };
    let from_first = unit.to_seconds(first.value()).abs() > LARGEST_KEPT_S;
    let origin = if from_first { first } else { Stamp { whole: 0, fraction: 0.0 } };
    let seconds = stamps.iter().map(|stamp| unit.to_seconds(stamp.since(origin))).collect();
    Times { seconds, unit, told, from_first }
}

/// Returns the unit of stamps that are whole numbers: milliseconds if they go on by 2 to 1000, microseconds by
/// more. Steps of 1 may be numbers of samples.
fn whole_steps(stamps: &[Stamp]) -> Option<TimeUnit> {
    if stamps.iter().any(|stamp| stamp.value().fract() != 0.0) {
        return None;
    }
    let steps = stamps.iter().zip(stamps.iter().skip(1)).map(|(one, next)| next.since(*one));
    match upper_median(steps.filter(|step| *step > 0.0).collect())? {
        step if (2.0..1e3).contains(&step) => Some(TimeUnit::Millisecond),
        step if (1e3..1e6).contains(&step) => Some(TimeUnit::Microsecond),
        _ => None,
    }
}

/// Returns the unit in which a number is a time between 1980 and 2100, if there is one.
fn since_1970(stamp: f64) -> Option<TimeUnit> {
    let units = [TimeUnit::Second, TimeUnit::Millisecond, TimeUnit::Microsecond, TimeUnit::Nanosecond];
    units.into_iter().find(|unit| (3.15e8..4.1e9).contains(&unit.to_seconds(stamp)))
}

#[cfg(test)]
mod tests {
    use super::{Stamp, seconds};
    use crate::dates::DateOrder;
    use crate::dialect::Dialect;
    use crate::unit::TimeUnit;

    fn read(cells: &[&str], unit: Option<TimeUnit>) -> (Vec<f64>, TimeUnit) {
        let dialect = Dialect { separator: ',', decimal_comma: false };
        let order = DateOrder::of(cells.iter().copied());
        let stamps: Vec<Stamp> =
            cells.iter().map(|cell| Stamp::parse(cell, dialect, order).unwrap()).collect();
        let times = seconds(&stamps, unit, cells[0].contains(':'));
        (times.seconds, times.unit)
    }

    #[test]
    fn times_since_1970_keep_their_differences() {
        let (ns, unit) = read(&["1714564800000000001", "1714564800010000004"], None);
        assert_eq!((ns, unit), (vec![0.0, 0.010000003], TimeUnit::Nanosecond));
        let (us, unit) = read(&["1714564800000001", "1714564800010001"], None);
        assert_eq!((us, unit), (vec![0.0, 0.01], TimeUnit::Microsecond));
        let (ms, unit) = read(&["1714564800000", "1714564800010"], None);
        assert_eq!((ms, unit), (vec![0.0, 0.01], TimeUnit::Millisecond));
        let (s, unit) = read(&["1714564800.125", "1714564800.250"], None);
        assert_eq!((s, unit), (vec![0.0, 0.125], TimeUnit::Second));
        assert_eq!(read(&["1488.998", "1489.008"], None).0, [1488.998, 1489.008]);
        assert_eq!(read(&["5", "15"], Some(TimeUnit::Millisecond)).0, [0.005, 0.015]);
    }

    #[test]
    fn dates_and_times_of_the_day() {
        for cells in [
            ["2024-05-01T12:00:00.125Z", "2024-05-01T12:00:00.250Z"],
            ["2024-05-01 12:00:00.125", "2024-05-01 12:00:00.250"],
            ["2024-05-01T12:00:00.125+02:00", "2024-05-01T12:00:00.250+02:00"],
            ["16:04:31.125", "16:04:31.250"],
            ["23:59:59.950", "00:00:00.075"],
            ["14.06.2023 10:00:00.125", "14.06.2023 10:00:00,250"],
            ["30.6.23 23:59:59.950", "1.7.23 0:00:00.075"],
            ["06/14/2023 9:59:59.950 AM", "06/14/2023 10:00:00.075 am"],
            ["11/30/2023 11:59:59.950 PM", "12/1/2023 12:00:00.075AM"],
            ["30/11/2023 23:59:59.950", "01/12/2023 00:00:00.075"],
            ["2023/11/30 12:59:59.950 PM", "2023/11/30 1:00:00.075 PM"],
            ["12:59:59.950 PM", "01:00:00.075 PM"],
        ] {
            assert_eq!(read(&cells, None), (vec![0.0, 0.125], TimeUnit::Iso), "{cells:?}");
        }
    }
}
