//! Nominal oscillator: the oscillator as the simulator knows it.

use crate::description::Range;
use crate::error::DynamicsError;
use crate::units::{Coordinate, Units};
use serde::{Deserialize, Serialize};

/// Nominal oscillator I·θ̈ + c·θ̇ + k·(θ − θ_rest) = g·u(t).
///
/// Numbers are in SI units (kg m², N m s/rad, N m/rad, rad for an angle; kg, N s/m, N/m, m for a
/// displacement), or all are divided by the inertia, which is then exactly 1 (1/s for damping, 1/s² for
/// stiffness). A stiffness of 0 describes a drive without a spring.
///
/// ```
/// use dynamics::Nominal;
/// // An arm of 5e-4 kg m² on a torsional spring; the same divided by its inertia swings alike.
/// let arm = Nominal::new(5e-4, 1.1e-4, 0.2365, 0.0)?;
/// let per_inertia = Nominal::new(1.0, 1.1e-4 / 5e-4, 0.2365 / 5e-4, 0.0)?;
/// assert!((arm.angular_frequency() - 21.75).abs() < 0.01, "√(k/I) in rad/s");
/// assert!((arm.angular_frequency() - per_inertia.angular_frequency()).abs() < 1e-12);
/// assert!(Nominal::new(0.0, 0.1, 1.0, 0.0).is_err(), "an inertia is above 0");
/// # Ok::<(), dynamics::DynamicsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Raw", into = "Raw")]
pub struct Nominal {
    coefficients: Coefficients<f64>,
    coordinate: Coordinate,
    sensor_resolution: Option<f64>,
}

/// Five coefficients of a nominal oscillator, over any scalar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients<S> {
    /// Moment of inertia, or mass; above 0.
    pub inertia: S,
    /// Viscous damping; 0 or above.
    pub damping: S,
    /// Stiffness of the spring; 0 or above.
    pub stiffness: S,
    /// Position of the relaxed spring, in rad or m.
    pub rest_angle: S,
    /// Torque per unit of the input.
    pub input_gain: S,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    inertia: f64,
    damping: f64,
    stiffness: f64,
    rest_angle: f64,
    #[serde(default = "one")]
    input_gain: f64,
    #[serde(default)]
    coordinate: Coordinate,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sensor_resolution: Option<f64>,
}

fn one() -> f64 {
    1.0
}

impl Nominal {
    /// Creates a nominal oscillator of an angle, with an input gain of 1.
    ///
    /// # Errors
    /// Returns [`DynamicsError::NominalOutOfRange`] unless the inertia is above 0, damping and stiffness are
    /// 0 or above, and every number is finite.
    pub fn new(inertia: f64, damping: f64, stiffness: f64, rest_angle: f64) -> Result<Self, DynamicsError> {
        Self::from_coefficients(Coefficients { inertia, damping, stiffness, rest_angle, input_gain: 1.0 })
    }

    /// Creates a nominal oscillator of an angle from all five coefficients.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::new`]; the input gain may be any finite number.
    pub fn from_coefficients(coefficients: Coefficients<f64>) -> Result<Self, DynamicsError> {
        for (parameter, value, range) in [
            ("inertia", coefficients.inertia, Range::POSITIVE),
            ("damping", coefficients.damping, Range::NON_NEGATIVE),
            ("stiffness", coefficients.stiffness, Range::NON_NEGATIVE),
            ("rest_angle", coefficients.rest_angle, Range::ANY),
            ("input_gain", coefficients.input_gain, Range::ANY),
        ] {
            if !range.contains(value) {
                return Err(DynamicsError::NominalOutOfRange { parameter, value, range });
            }
        }
        Ok(Self { coefficients, coordinate: Coordinate::Angle, sensor_resolution: None })
    }

    /// Returns the same numbers read in another coordinate: an angle in radians or a displacement in meters.
    /// Nothing is converted.
    #[must_use]
    pub fn with_coordinate(self, coordinate: Coordinate) -> Self {
        Self { coordinate, ..self }
    }

    /// Returns the same oscillator with the sensor's stated resolution, in the coordinate's unit.
    ///
    /// # Errors
    /// Returns [`DynamicsError::NominalOutOfRange`] unless the resolution is above 0.
    pub fn with_sensor_resolution(self, resolution: f64) -> Result<Self, DynamicsError> {
        if !Range::POSITIVE.contains(resolution) {
            return Err(DynamicsError::NominalOutOfRange {
                parameter: "sensor_resolution",
                value: resolution,
                range: Range::POSITIVE,
            });
        }
        Ok(Self { sensor_resolution: Some(resolution), ..self })
    }

    /// Returns the same oscillator with other coefficients.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::from_coefficients`].
    pub fn with_coefficients(self, coefficients: Coefficients<f64>) -> Result<Self, DynamicsError> {
        let checked = Self::from_coefficients(coefficients)?;
        Ok(Self { coefficients: checked.coefficients, ..self })
    }

    /// Returns all coefficients, in SI units, or per inertia if the inertia is 1.
    #[must_use]
    pub fn coefficients(&self) -> Coefficients<f64> {
        self.coefficients
    }

    /// Returns the moment of inertia in kg m², the mass in kg, or 1.
    #[must_use]
    pub fn inertia(&self) -> f64 {
        self.coefficients.inertia
    }

    /// Returns the viscous damping in N m s/rad, N s/m, or 1/s.
    #[must_use]
    pub fn damping(&self) -> f64 {
        self.coefficients.damping
    }

    /// Returns the stiffness in N m/rad, N/m, or 1/s².
    #[must_use]
    pub fn stiffness(&self) -> f64 {
        self.coefficients.stiffness
    }

    /// Returns the position of the relaxed spring, in rad or m.
    #[must_use]
    pub fn rest_angle(&self) -> f64 {
        self.coefficients.rest_angle
    }

    /// Returns the torque (N m) or force (N) per unit of input; with an inertia of 1, the acceleration in
    /// rad/s² or m/s² per unit of input.
    #[must_use]
    pub fn input_gain(&self) -> f64 {
        self.coefficients.input_gain
    }

    /// Returns `true` if the input is a position that the spring pulls the body to: its gain is the stiffness.
    #[must_use]
    pub fn commands_position(&self) -> bool {
        let Coefficients { stiffness, input_gain, .. } = self.coefficients;
        (input_gain - stiffness).abs() <= f64::EPSILON * stiffness
    }

    /// Returns the coordinate: angle or displacement.
    #[must_use]
    pub fn coordinate(&self) -> Coordinate {
        self.coordinate
    }

    /// Returns the sensor's stated resolution in the coordinate's unit; `None` if unknown.
    #[must_use]
    pub fn sensor_resolution(&self) -> Option<f64> {
        self.sensor_resolution
    }

    /// Returns the undamped angular frequency √(k/I) in rad/s; 0 without a spring.
    #[must_use]
    pub fn angular_frequency(&self) -> f64 {
        (self.stiffness() / self.inertia()).sqrt()
    }

    /// Returns the units of the numbers: per inertia if the inertia is exactly 1.
    #[must_use]
    pub fn units(&self) -> Units {
        if self.inertia() == 1.0 { Units::PerInertia(self.coordinate) } else { Units::Si(self.coordinate) }
    }
}

impl TryFrom<Raw> for Nominal {
    type Error = DynamicsError;

    fn try_from(raw: Raw) -> Result<Self, DynamicsError> {
        let nominal = Self::from_coefficients(Coefficients {
            inertia: raw.inertia,
            damping: raw.damping,
            stiffness: raw.stiffness,
            rest_angle: raw.rest_angle,
            input_gain: raw.input_gain,
        })?
        .with_coordinate(raw.coordinate);
        raw.sensor_resolution.map_or(Ok(nominal), |resolution| nominal.with_sensor_resolution(resolution))
    }
}

impl From<Nominal> for Raw {
    fn from(nominal: Nominal) -> Self {
        let Coefficients { inertia, damping, stiffness, rest_angle, input_gain } = nominal.coefficients;
        Self {
            inertia,
            damping,
            stiffness,
            rest_angle,
            input_gain,
            coordinate: nominal.coordinate,
            sensor_resolution: nominal.sensor_resolution,
        }
    }
}
