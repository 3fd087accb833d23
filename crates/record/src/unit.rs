//! Units of record files and their conversion to SI.

use serde::{Deserialize, Serialize};

/// Unit of an observed column or of an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "&'static str")]
#[expect(missing_docs, reason = "each variant's symbol stands in the table below")]
pub enum Unit {
    Radian,
    Degree,
    Milliradian,
    Turn,
    Meter,
    Centimeter,
    Millimeter,
    Micrometer,
    Inch,
    Volt,
    RadianPerSecond,
    DegreePerSecond,
    TurnPerMinute,
    MeterPerSecond,
    CentimeterPerSecond,
    MillimeterPerSecond,
    RadianPerSecondSquared,
    DegreePerSecondSquared,
    MeterPerSecondSquared,
    StandardGravity,
    NewtonMeter,
    MillinewtonMeter,
    Newton,
    Millinewton,
    Kilonewton,
    Ampere,
    Milliampere,
    Millivolt,
    KilogramForce,
    KilogramForceMeter,
    KilogramForceCentimeter,
    Strain,
    Microstrain,
}

/// Dimension of a quantity: decides if a column can be observed or be an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dimension {
    /// An angle or one of its derivatives.
    Angle,
    /// A length or one of its derivatives.
    Length,
    /// A voltage, which represents a displacement or drives a system.
    Voltage,
    /// A strain, which represents a displacement.
    Strain,
    /// A force, which drives a system or, alone beside a time, represents a displacement.
    Force,
    /// A torque or a current: only an input, never observed.
    Drive,
}

/// Row of one unit: symbol, factor to SI, SI symbol, dimension, order of the derivative, other spellings in
/// lower case without blanks.
type Row = (Unit, &'static str, f64, &'static str, Dimension, usize, &'static [&'static str]);

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const TURN: f64 = std::f64::consts::TAU;
/// Standard gravity, in m/s².
const GRAVITY: f64 = 9.806_65;

use Dimension::{Angle, Drive, Force, Length, Strain, Voltage};

/// All units. [`Unit::NAMES`] are those that can be observed.
#[rustfmt::skip]
const TABLE: &[Row] = &[
    (Unit::Radian, "rad", 1.0, "rad", Angle, 0, &["radian", "radians"]),
    (Unit::Degree, "deg", DEGREE, "rad", Angle, 0, &["degree", "degrees", "°"]),
    (Unit::Milliradian, "mrad", 1e-3, "rad", Angle, 0, &["milliradian", "milliradians"]),
    (Unit::Turn, "turn", TURN, "rad", Angle, 0, &["turns", "rev", "revs", "revolutions"]),
    (Unit::Meter, "m", 1.0, "m", Length, 0, &["meter", "meters", "metre", "metres"]),
    (Unit::Centimeter, "cm", 1e-2, "m", Length, 0, &["centimeter", "centimeters"]),
    (Unit::Millimeter, "mm", 1e-3, "m", Length, 0, &["millimeter", "millimeters", "millimetre"]),
    (Unit::Micrometer, "um", 1e-6, "m", Length, 0, &["µm", "μm", "micrometer", "micrometers", "micron", "microns"]),
    (Unit::Inch, "in", 0.0254, "m", Length, 0, &["inch", "inches"]),
    (Unit::Volt, "V", 1.0, "V", Voltage, 0, &["volt", "volts"]),
    (Unit::RadianPerSecond, "rad/s", 1.0, "rad/s", Angle, 1, &["rad_s", "rad/sec", "radps", "rad_per_s", "rads^-1"]),
    (Unit::DegreePerSecond, "deg/s", DEGREE, "rad/s", Angle, 1, &["deg_s", "deg/sec", "degps", "dps", "°/s", "deg_per_s"]),
    (Unit::TurnPerMinute, "rpm", TURN / 60.0, "rad/s", Angle, 1, &["1/min", "rev/min", "turn/min"]),
    (Unit::MeterPerSecond, "m/s", 1.0, "m/s", Length, 1, &["m_s", "m/sec", "mps", "m_per_s", "ms^-1"]),
    (Unit::CentimeterPerSecond, "cm/s", 1e-2, "m/s", Length, 1, &["cm_s", "cm/sec"]),
    (Unit::MillimeterPerSecond, "mm/s", 1e-3, "m/s", Length, 1, &["mm_s", "mm/sec"]),
    (Unit::RadianPerSecondSquared, "rad/s^2", 1.0, "rad/s^2", Angle, 2, &["rad_s2", "rad/s2", "rad/s²", "rad/s/s", "rad_per_s2"]),
    (Unit::DegreePerSecondSquared, "deg/s^2", DEGREE, "rad/s^2", Angle, 2, &["deg_s2", "deg/s2", "deg/s²", "°/s²", "°/s^2"]),
    (Unit::MeterPerSecondSquared, "m/s^2", 1.0, "m/s^2", Length, 2, &["m_s2", "m/s2", "m/s²", "m/s/s", "m/sec^2", "m/s**2", "m_per_s2"]),
    (Unit::StandardGravity, "g", GRAVITY, "m/s^2", Length, 2, &["g0", "gn"]),
    (Unit::NewtonMeter, "N m", 1.0, "N m", Drive, 0, &["nm", "n_m", "n*m", "n·m", "n-m", "newtonmeter", "newtonmeters"]),
    (Unit::MillinewtonMeter, "mN m", 1e-3, "N m", Drive, 0, &["mnm", "mn_m", "mn*m", "mn·m"]),
    (Unit::Newton, "N", 1.0, "N", Force, 0, &["newton", "newtons"]),
    (Unit::Millinewton, "mN", 1e-3, "N", Force, 0, &["millinewton"]),
    (Unit::Kilonewton, "kN", 1e3, "N", Force, 0, &["kilonewton"]),
    (Unit::Ampere, "A", 1.0, "A", Drive, 0, &["amp", "amps", "ampere", "amperes"]),
    (Unit::Milliampere, "mA", 1e-3, "A", Drive, 0, &["milliamp", "milliamps"]),
    (Unit::Millivolt, "mV", 1e-3, "V", Voltage, 0, &["millivolt", "millivolts"]),
    (Unit::KilogramForce, "kgf", GRAVITY, "N", Force, 0, &["kp", "kilopond", "kg_f"]),
    (Unit::KilogramForceMeter, "kgf m", GRAVITY, "N m", Drive, 0, &["kgf_m", "kgf*m", "kgf·m", "kgf-m", "kgm", "kg_m", "kg*m", "kg·m", "kg-m"]),
    (Unit::KilogramForceCentimeter, "kgf cm", 1e-2 * GRAVITY, "N m", Drive, 0, &["kgf_cm", "kgf*cm", "kgf·cm", "kgf-cm", "kgcm", "kg_cm", "kg*cm", "kg·cm", "kg-cm"]),
    (Unit::Strain, "m/m", 1.0, "m/m", Strain, 0, &["mm/mm"]),
    (Unit::Microstrain, "um/m", 1e-6, "m/m", Strain, 0, &["µm/m", "μm/m", "µε", "με", "ue", "microstrain", "ustrain", "µstrain", "μstrain"]),
];

impl Unit {
    /// Symbols of all units that can be observed, as configurations write them.
    pub const NAMES: &'static [&'static str] = &[
        "rad", "deg", "mrad", "turn", "m", "cm", "mm", "um", "in", "V", "rad/s", "deg/s", "rpm", "m/s",
        "cm/s", "mm/s", "rad/s^2", "deg/s^2", "m/s^2", "g", "mV", "m/m", "um/m", "N", "mN", "kN", "kgf",
    ];

    /// Symbols of all units that an input can have, as configurations write them.
    pub const INPUT_NAMES: &'static [&'static str] = &[
        "N m", "mN m", "kgf m", "kgf cm", "N", "mN", "kN", "kgf", "V", "mV", "A", "mA", "rad", "deg", "mrad",
        "turn", "m", "cm", "mm", "um", "in", "rad/s", "deg/s", "rpm", "m/s", "cm/s", "mm/s",
    ];

    /// Returns the unit with a symbol or another spelling, such as `deg`, `degrees` or `°`.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let text: String = text.chars().filter(|sign| !sign.is_whitespace()).collect();
        let lower = text.to_lowercase();
        // Case distinguishes mN from MN, and nothing else that occurs in logs.
        let row = TABLE.iter().find(|row| row.1.replace(' ', "") == text);
        row.or_else(|| {
            TABLE
                .iter()
                .find(|row| row.1.replace(' ', "").to_lowercase() == lower || row.6.contains(&lower.as_str()))
        })
        .map(|row| row.0)
    }

    fn row(self) -> &'static Row {
        // The fallback is never used: every unit has a row, which a test checks.
        TABLE.iter().find(|row| row.0 == self).unwrap_or(&TABLE_FIRST)
    }

    /// Returns the symbol used in configurations.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        self.row().1
    }

    /// Returns the factor from this unit to the SI unit of [`Unit::si`].
    #[must_use]
    pub fn to_si(self) -> f64 {
        self.row().2
    }

    /// Returns the symbol of the SI unit in which values are stored.
    #[must_use]
    pub fn si(self) -> &'static str {
        self.row().3
    }

    /// Returns `true` for the signal of a sensor that represents a displacement by a factor of its own: a voltage, a strain
    /// or a force.
    #[must_use]
    pub fn is_signal(self) -> bool {
        matches!(self.dimension(), Dimension::Voltage | Dimension::Strain | Dimension::Force)
    }

    pub(crate) fn dimension(self) -> Dimension {
        self.row().4
    }

    /// Returns the order of the time derivative: 0 for positions, 1 for velocities, 2 for accelerations.
    pub(crate) fn order(self) -> usize {
        self.row().5
    }
}

const TABLE_FIRST: Row = (Unit::Radian, "rad", 1.0, "rad", Angle, 0, &[]);

impl From<Unit> for &'static str {
    fn from(unit: Unit) -> Self {
        unit.symbol()
    }
}

impl TryFrom<String> for Unit {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        Self::parse(&text)
            .ok_or_else(|| format!("`{text}` is no unit; expected one of {}", Self::NAMES.join(", ")))
    }
}

/// Unit of the time column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum TimeUnit {
    /// Second.
    #[default]
    #[serde(rename = "s")]
    Second,
    /// Millisecond.
    #[serde(rename = "ms")]
    Millisecond,
    /// Microsecond.
    #[serde(rename = "us")]
    Microsecond,
    /// Nanosecond.
    #[serde(rename = "ns")]
    Nanosecond,
    /// Minute.
    #[serde(rename = "min")]
    Minute,
    /// Hour.
    #[serde(rename = "h")]
    Hour,
    /// Dates and times of ISO 8601, or times of day as `HH:MM:SS.mmm`.
    #[serde(rename = "iso")]
    Iso,
}

impl TimeUnit {
    /// Names of all units of time in configurations.
    pub const NAMES: &'static [&'static str] = &["s", "ms", "us", "ns", "min", "h", "iso"];

    /// Returns the name used in configurations.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Second => "s",
            Self::Millisecond => "ms",
            Self::Microsecond => "us",
            Self::Nanosecond => "ns",
            Self::Minute => "min",
            Self::Hour => "h",
            Self::Iso => "iso",
        }
    }

    /// Returns the unit with a name or another spelling, such as `ms`, `msec` or `milliseconds`.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        match text.trim().to_lowercase().as_str() {
            "s" | "sec" | "secs" | "second" | "seconds" => Some(Self::Second),
            "ms" | "msec" | "msecs" | "millis" | "milliseconds" => Some(Self::Millisecond),
            "us" | "µs" | "μs" | "usec" | "usecs" | "micros" | "microseconds" => Some(Self::Microsecond),
            "ns" | "nsec" | "nsecs" | "nanos" | "nanoseconds" => Some(Self::Nanosecond),
            "min" | "mins" | "minute" | "minutes" => Some(Self::Minute),
            "h" | "hr" | "hrs" | "hour" | "hours" => Some(Self::Hour),
            "iso" | "iso8601" | "iso-8601" => Some(Self::Iso),
            _ => None,
        }
    }

    /// Converts a stamp to seconds. Divides by a whole power of ten, which rounds once; multiplying by `1e-3`
    /// would round twice.
    #[must_use]
    pub fn to_seconds(self, stamp: f64) -> f64 {
        match self {
            Self::Second | Self::Iso => stamp,
            Self::Millisecond => stamp / 1e3,
            Self::Microsecond => stamp / 1e6,
            Self::Nanosecond => stamp / 1e9,
            Self::Minute => stamp * 60.0,
            Self::Hour => stamp * 3600.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{TABLE, Unit};

    #[test]
    fn every_unit_has_one_row_and_is_found_by_each_spelling() {
        for (at, row) in TABLE.iter().enumerate() {
            assert_eq!(row.0 as usize, at, "{}", row.1);
            for text in row.6.iter().chain([&row.1]) {
                assert_eq!(Unit::parse(text), Some(row.0), "{text}");
            }
        }
        for name in Unit::NAMES.iter().chain(Unit::INPUT_NAMES) {
            assert_eq!(Unit::parse(name).unwrap().symbol(), *name);
        }
        assert_eq!(Unit::parse("N m").unwrap().si(), "N m");
        assert_eq!(Unit::parse("furlong"), None);
    }
}
