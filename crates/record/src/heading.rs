//! Parsing of a column title into name and unit.

use crate::unit::{TimeUnit, Unit};

/// A unit of time, or another unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Measure {
    Time(TimeUnit),
    Value(Unit),
}

/// A column title split into its parts.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Heading {
    /// Title as written.
    pub(crate) title: String,
    /// Words of the name in lower case, without trailing digits: `field.position0` gives `field` and
    /// `position`.
    pub(crate) words: Vec<String>,
    /// Unit stated by the title or by the line of units below it.
    pub(crate) measure: Option<Measure>,
    /// Unknown text at the place of a unit: in brackets after the name, or below the title.
    pub(crate) unknown: Option<String>,
}

/// Endings that are units only after certain names: `swing_a` is not in amperes.
const DOUBTFUL: &[(&str, &[&str])] = &[
    ("a", &["current"]),
    ("n", &["force", "load"]),
    // A column `h` is a height, and `min` a minimum.
    ("h", &["t", "time", "elapsed", "duration"]),
    ("min", &["t", "time", "elapsed", "duration"]),
    ("kg_m", &["torque", "moment"]),
    ("kg m", &["torque", "moment"]),
    ("kgm", &["torque", "moment"]),
    ("g", &["acc", "accel", "acceleration"]),
    ("in", &["displacement", "position", "pos", "travel"]),
];

impl Heading {
    /// Parses a title: `angle [deg]`, `time (ms)`, `angle / deg`, `t/ms`, `velocity_rad_s`, `deg`. `below` is
    /// the cell in a line of units, which is used if the title states no unit.
    pub(crate) fn parse(title: &str, below: Option<&str>) -> Self {
        let title = title.trim();
        let (name, measure) = bracketed(title).unwrap_or_else(|| suffixed(title));
        let below = below.map(|unit| unit.trim_matches(['[', ']', '(', ')']).trim());
        let measure = measure.or_else(|| below.and_then(measure_of));
        let stated = in_brackets(title).map(|(_, unit)| unit.trim()).or(below);
        let unknown =
            stated.filter(|unit| measure.is_none() && !unit.is_empty() && *unit != "-" && *unit != "1");
        Self { title: title.to_owned(), words: words(name), measure, unknown: unknown.map(str::to_owned) }
    }

    pub(crate) fn unit(&self) -> Option<Unit> {
        match self.measure {
            Some(Measure::Value(unit)) => Some(unit),
            _ => None,
        }
    }

    pub(crate) fn time_unit(&self) -> Option<TimeUnit> {
        match self.measure {
            Some(Measure::Time(unit)) => Some(unit),
            _ => None,
        }
    }

    /// Returns the title without a unit in brackets: `q1` for `q1 [rad]`.
    pub(crate) fn without_unit(&self) -> &str {
        in_brackets(&self.title).map_or(self.title.as_str(), |(name, _)| name).trim()
    }

    pub(crate) fn has(&self, word: &str) -> bool {
        self.words.iter().any(|own| own == word)
    }
}

/// Returns the unit that a text names.
pub(crate) fn measure_of(text: &str) -> Option<Measure> {
    TimeUnit::parse(text).map(Measure::Time).or_else(|| Unit::parse(text).map(Measure::Value))
}

/// Returns the name and the text in brackets after it.
fn in_brackets(title: &str) -> Option<(&str, &str)> {
    [('[', ']'), ('(', ')')].into_iter().find_map(|(open, close)| {
        let (name, rest) = title.rsplit_once(open)?;
        let (unit, _) = rest.split_once(close)?;
        (!name.trim().is_empty()).then_some((name, unit))
    })
}

/// Parses `name [unit]`, `name (unit)`, `name / unit` or `name in unit`.
fn bracketed(title: &str) -> Option<(&str, Option<Measure>)> {
    if let Some((name, unit)) = in_brackets(title) {
        return Some((name, measure_of(unit)));
    }
    [" / ", " in ", ", "].iter().find_map(|between| {
        let (name, unit) = title.rsplit_once(between)?;
        measure_of(unit).map(|measure| (name, Some(measure)))
    })
}

/// Parses `name_unit` or `name/unit` with the longest ending that is a unit. A name that is a unit of time is
/// a time, and a name that is another unit of two letters or more is a quantity in that unit.
fn suffixed(title: &str) -> (&str, Option<Measure>) {
    let doubtful =
        |ending: &str| DOUBTFUL.iter().find(|(unit, _)| ending.eq_ignore_ascii_case(unit)).map(|row| row.1);
    let is_time = |unit: &TimeUnit| *unit != TimeUnit::Iso && doubtful(title).is_none();
    if let Some(unit) = TimeUnit::parse(title).filter(is_time) {
        return (title, Some(Measure::Time(unit)));
    }
    let whole = Unit::parse(title).filter(|_| title.chars().nth(1).is_some() && doubtful(title).is_none());
    if let Some(unit) = whole {
        return (title, Some(Measure::Value(unit)));
    }
    let breaks = title.match_indices(['_', ' ', '.', '-', '/']).map(|(at, sign)| (at, at + sign.len()));
    for (end, start) in breaks {
        let (Some(name), Some(ending)) = (title.get(..end), title.get(start..)) else { continue };
        // `N/m` is a stiffness, not a force in meters.
        let is_ratio = title.get(end..start) == Some("/") && measure_of(name).is_some();
        let Some(measure) = measure_of(ending).filter(|_| !name.is_empty() && !is_ratio) else { continue };
        let doubtful = doubtful(ending);
        if doubtful.is_none_or(|names| words(name).iter().any(|word| names.contains(&word.as_str()))) {
            return (name, Some(measure));
        }
    }
    (title, None)
}

/// Returns the words of a name, split at signs and where a capital follows a small letter, without trailing
/// digits.
fn words(name: &str) -> Vec<String> {
    let mut found = vec![String::new()];
    let mut small = false;
    for sign in name.chars() {
        if !sign.is_alphanumeric() || (sign.is_uppercase() && small) {
            found.push(String::new());
        }
        small = sign.is_lowercase();
        if let Some(last) = found.last_mut().filter(|_| sign.is_alphanumeric()) {
            last.extend(sign.to_lowercase());
        }
    }
    let cut = |word: String| word.trim_end_matches(|sign: char| sign.is_ascii_digit()).to_owned();
    found.into_iter().map(cut).filter(|word| !word.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::{Heading, Measure};
    use crate::unit::{TimeUnit, Unit};

    #[test]
    fn names_and_units_are_taken_apart() {
        let time = |unit| Some(Measure::Time(unit));
        let value = |unit| Some(Measure::Value(unit));
        for (title, words, measure) in [
            ("angle [deg]", "angle", value(Unit::Degree)),
            ("angle (rad)", "angle", value(Unit::Radian)),
            ("angle_deg", "angle", value(Unit::Degree)),
            ("theta_rad", "theta", value(Unit::Radian)),
            ("pos_mm", "pos", value(Unit::Millimeter)),
            ("Winkel / °", "winkel", value(Unit::Degree)),
            ("time (ms)", "time", time(TimeUnit::Millisecond)),
            ("timestamp_ms", "timestamp", time(TimeUnit::Millisecond)),
            ("t_us", "t", time(TimeUnit::Microsecond)),
            ("Time (min)", "time", time(TimeUnit::Minute)),
            ("t [h]", "t", time(TimeUnit::Hour)),
            ("angle_min", "angle min", None),
            ("Time [s]", "time", time(TimeUnit::Second)),
            ("Time_Elapsed(s)", "time elapsed", time(TimeUnit::Second)),
            ("millis", "millis", time(TimeUnit::Millisecond)),
            ("displacement_m", "displacement", value(Unit::Meter)),
            ("velocity_rad_s", "velocity", value(Unit::RadianPerSecond)),
            ("gyro_z (deg/s)", "gyro z", value(Unit::DegreePerSecond)),
            ("acceleration_m_s2", "acceleration", value(Unit::MeterPerSecondSquared)),
            ("accel [g]", "accel", value(Unit::StandardGravity)),
            ("torque [N m]", "torque", value(Unit::NewtonMeter)),
            ("torque_nm", "torque", value(Unit::NewtonMeter)),
            ("torque_mNm", "torque", value(Unit::MillinewtonMeter)),
            ("force_n", "force", value(Unit::Newton)),
            ("vir_V", "vir", value(Unit::Volt)),
            ("current_a", "current", value(Unit::Ampere)),
            ("t/ms", "t", time(TimeUnit::Millisecond)),
            ("Winkel/deg", "winkel", value(Unit::Degree)),
            ("x/mm", "x", value(Unit::Millimeter)),
            ("omega/rad/s", "omega", value(Unit::RadianPerSecond)),
            ("deg", "deg", value(Unit::Degree)),
            ("deg/s", "deg s", value(Unit::DegreePerSecond)),
            ("N/m", "n m", None),
            ("x/a", "x a", None),
            ("swing_a", "swing a", None),
            ("signal_in", "signal in", None),
            ("field.position0", "field position", None),
            ("%time", "time", None),
            ("jointAngle", "joint angle", None),
            ("", "", None),
        ] {
            let found = Heading::parse(title, None);
            assert_eq!((found.words.join(" ").as_str(), found.measure), (words, measure), "{title}");
        }
        let below = Heading::parse("Weg", Some("[mm]"));
        assert_eq!(below.unit(), Some(Unit::Millimeter));
        assert_eq!(Heading::parse("angle_deg", Some("rad")).unit(), Some(Unit::Degree));
    }
}
