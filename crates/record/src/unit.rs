//! Units that record files use, and their way to SI.

use serde::{Deserialize, Serialize};

/// Unit of the observed column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unit {
    /// Radian.
    #[serde(rename = "rad")]
    Radian,
    /// Degree of angle.
    #[serde(rename = "deg")]
    Degree,
    /// Meter.
    #[serde(rename = "m")]
    Meter,
    /// Millimeter.
    #[serde(rename = "mm")]
    Millimeter,
    /// Volt: an analog whose displacement is a voltage.
    #[serde(rename = "V")]
    Volt,
    /// Radian per second.
    #[serde(rename = "rad/s")]
    RadianPerSecond,
    /// Degree per second.
    #[serde(rename = "deg/s")]
    DegreePerSecond,
    /// Meter per second.
    #[serde(rename = "m/s")]
    MeterPerSecond,
    /// Radian per second squared.
    #[serde(rename = "rad/s^2")]
    RadianPerSecondSquared,
    /// Meter per second squared.
    #[serde(rename = "m/s^2")]
    MeterPerSecondSquared,
}

impl Unit {
    /// Every unit's name as configurations write it.
    pub const NAMES: &'static [&'static str] =
        &["rad", "deg", "m", "mm", "V", "rad/s", "deg/s", "m/s", "rad/s^2", "m/s^2"];

    /// Factor from this unit to the SI unit of [`Unit::si`].
    #[must_use]
    pub fn to_si(self) -> f64 {
        match self {
            Self::Degree | Self::DegreePerSecond => std::f64::consts::PI / 180.0,
            Self::Millimeter => 1e-3,
            _ => 1.0,
        }
    }

    /// Symbol of the SI unit that values are kept in.
    #[must_use]
    pub fn si(self) -> &'static str {
        match self {
            Self::Radian | Self::Degree => "rad",
            Self::Meter | Self::Millimeter => "m",
            Self::Volt => "V",
            Self::RadianPerSecond | Self::DegreePerSecond => "rad/s",
            Self::MeterPerSecond => "m/s",
            Self::RadianPerSecondSquared => "rad/s^2",
            Self::MeterPerSecondSquared => "m/s^2",
        }
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
}

impl TimeUnit {
    /// Every unit's name as configurations write it.
    pub const NAMES: &'static [&'static str] = &["s", "ms", "us"];

    /// Stamp in seconds. Divides by a whole power of ten, which rounds once; multiplying by `1e-3`
    /// would round twice.
    #[must_use]
    pub fn to_seconds(self, stamp: f64) -> f64 {
        match self {
            Self::Second => stamp,
            Self::Millisecond => stamp / 1e3,
            Self::Microsecond => stamp / 1e6,
        }
    }
}
