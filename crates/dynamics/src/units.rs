//! Units of a system's numbers.

use serde::{Deserialize, Serialize};

/// Coordinate of a system: an angle or a displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Coordinate {
    /// An angle in radians; generalized forces are torques.
    #[default]
    Angle,
    /// A displacement in meters (or in a sensor's own unit, which then takes the meter's place).
    Displacement,
}

/// Quantity of the motion that the sensor observes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Observed {
    /// Position itself: an encoder.
    #[default]
    Position,
    /// First derivative of the position: a gyroscope, a laser vibrometer.
    Velocity,
    /// Second derivative of the position: an accelerometer.
    Acceleration,
}

/// System of units in which a system's numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Units {
    /// SI, inertia in kg m² or kg.
    Si(Coordinate),
    /// Every torque, stiffness and damping divided by the inertia, which is then 1.
    PerInertia(Coordinate),
}

/// Physical quantity that a parameter measures; its unit follows from the system's [`Units`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Moment of inertia, or mass.
    Inertia,
    /// Torque, or force.
    Torque,
    /// Position: angle or displacement.
    Position,
    /// Velocity of the coordinate.
    Velocity,
    /// Torque per position.
    Stiffness,
    /// Torque per position squared.
    QuadraticStiffness,
    /// Torque per position cubed.
    CubicStiffness,
    /// Torque per position to the fifth power.
    QuinticStiffness,
    /// Torque per velocity.
    Damping,
    /// Torque per velocity squared.
    QuadraticDamping,
    /// Torque per velocity cubed.
    CubicDamping,
    /// Torque per velocity and position squared.
    DeflectionDamping,
    /// Reciprocal of a velocity.
    InverseVelocity,
    /// Radians of a wave per radian or meter of the position; for an angle, waves per turn.
    Wavenumber,
    /// A duration.
    Time,
    /// Relative change per time.
    Rate,
    /// Angular frequency.
    AngularFrequency,
    /// An angle, whatever the coordinate.
    Angle,
    /// Quantity that the sensor observes: a position, or its first or second derivative.
    Observed,
    /// Change of the observed quantity per second.
    ObservedPerTime,
    /// Share, or relative change.
    Ratio,
    /// A number of samples.
    Samples,
}

impl Quantity {
    /// Returns the unit's symbol, such as `N m/rad`; for [`Quantity::Observed`] that of a sensor of
    /// positions.
    #[must_use]
    pub const fn unit(self, units: Units) -> &'static str {
        use Coordinate::{Angle, Displacement};
        match (self, units) {
            (Self::Ratio, _) => "1",
            (Self::Samples, _) => "samples",
            (Self::Observed, Units::Si(Angle) | Units::PerInertia(Angle)) => "rad",
            (Self::Observed, _) => "m",
            (Self::ObservedPerTime, Units::Si(Angle) | Units::PerInertia(Angle)) => "rad/s",
            (Self::ObservedPerTime, _) => "m/s",
            (Self::Time, _) => "s",
            (Self::Rate, _) => "1/s",
            (Self::AngularFrequency, _) => "rad/s",
            (Self::Angle, _) | (Self::Position, Units::Si(Angle) | Units::PerInertia(Angle)) => "rad",
            (Self::Position, _) => "m",
            (Self::Velocity, Units::Si(Angle) | Units::PerInertia(Angle)) => "rad/s",
            (Self::Velocity, _) => "m/s",
            (Self::InverseVelocity, Units::Si(Angle) | Units::PerInertia(Angle)) => "s/rad",
            (Self::InverseVelocity, _) => "s/m",
            (Self::Wavenumber, Units::Si(Angle) | Units::PerInertia(Angle)) => "1",
            (Self::Wavenumber, _) => "rad/m",
            (Self::Inertia, Units::Si(Angle)) => "kg m^2",
            (Self::Inertia, Units::Si(Displacement)) => "kg",
            (Self::Inertia, _) => "1",
            (Self::Torque, Units::Si(Angle)) => "N m",
            (Self::Torque, Units::Si(Displacement)) => "N",
            (Self::Torque, Units::PerInertia(Angle)) => "rad/s^2",
            (Self::Torque, Units::PerInertia(Displacement)) => "m/s^2",
            (Self::Stiffness, Units::Si(Angle)) => "N m/rad",
            (Self::Stiffness, Units::Si(Displacement)) => "N/m",
            (Self::Stiffness, Units::PerInertia(_)) => "1/s^2",
            (Self::QuadraticStiffness, Units::Si(Angle)) => "N m/rad^2",
            (Self::QuadraticStiffness, Units::Si(Displacement)) => "N/m^2",
            (Self::QuadraticStiffness, Units::PerInertia(Angle)) => "1/(rad s^2)",
            (Self::QuadraticStiffness, Units::PerInertia(Displacement)) => "1/(m s^2)",
            (Self::CubicStiffness, Units::Si(Angle)) => "N m/rad^3",
            (Self::CubicStiffness, Units::Si(Displacement)) => "N/m^3",
            (Self::CubicStiffness, Units::PerInertia(Angle)) => "1/(rad^2 s^2)",
            (Self::CubicStiffness, Units::PerInertia(Displacement)) => "1/(m^2 s^2)",
            (Self::QuinticStiffness, Units::Si(Angle)) => "N m/rad^5",
            (Self::QuinticStiffness, Units::Si(Displacement)) => "N/m^5",
            (Self::QuinticStiffness, Units::PerInertia(Angle)) => "1/(rad^4 s^2)",
            (Self::QuinticStiffness, Units::PerInertia(Displacement)) => "1/(m^4 s^2)",
            (Self::Damping, Units::Si(Angle)) => "N m s/rad",
            (Self::Damping, Units::Si(Displacement)) => "N s/m",
            (Self::Damping, Units::PerInertia(_)) => "1/s",
            (Self::QuadraticDamping, Units::Si(Angle)) => "N m s^2/rad^2",
            (Self::QuadraticDamping, Units::Si(Displacement)) => "N s^2/m^2",
            (Self::QuadraticDamping, Units::PerInertia(Angle)) => "1/rad",
            (Self::QuadraticDamping, Units::PerInertia(Displacement)) => "1/m",
            (Self::CubicDamping, Units::Si(Angle)) => "N m s^3/rad^3",
            (Self::CubicDamping, Units::Si(Displacement)) => "N s^3/m^3",
            (Self::CubicDamping, Units::PerInertia(Angle)) => "s/rad^2",
            (Self::CubicDamping, Units::PerInertia(Displacement)) => "s/m^2",
            (Self::DeflectionDamping, Units::Si(Angle)) => "N m s/rad^3",
            (Self::DeflectionDamping, Units::Si(Displacement)) => "N s/m^3",
            (Self::DeflectionDamping, Units::PerInertia(Angle)) => "1/(rad^2 s)",
            (Self::DeflectionDamping, Units::PerInertia(Displacement)) => "1/(m^2 s)",
        }
    }

    /// Returns the unit's symbol for a sensor that observes positions, velocities or accelerations. The units
    /// of [`Quantity::Observed`] and [`Quantity::ObservedPerTime`] depend on it, all others are those of
    /// [`Self::unit`].
    #[must_use]
    pub fn unit_seen(self, units: Units, observed: Observed) -> &'static str {
        let derivatives = match observed {
            Observed::Position => 0,
            Observed::Velocity => 1,
            Observed::Acceleration => 2,
        };
        let order = match self {
            Self::Observed => derivatives,
            Self::ObservedPerTime => derivatives + 1,
            _ => return self.unit(units),
        };
        let (Units::Si(coordinate) | Units::PerInertia(coordinate)) = units;
        match (coordinate, order) {
            (Coordinate::Angle, 0) => "rad",
            (Coordinate::Angle, 1) => "rad/s",
            (Coordinate::Angle, 2) => "rad/s^2",
            (Coordinate::Angle, _) => "rad/s^3",
            (Coordinate::Displacement, 0) => "m",
            (Coordinate::Displacement, 1) => "m/s",
            (Coordinate::Displacement, 2) => "m/s^2",
            (Coordinate::Displacement, _) => "m/s^3",
        }
    }
}
