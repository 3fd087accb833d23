//! Classes of effects that act alike.

/// Class of effects that act alike; composite cases are scored by class.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum EffectClass {
    /// Dry friction and hysteresis.
    Friction,
    /// Nonlinear springs and gravity.
    Restoring,
    /// Drag, and damping that changes.
    Damping,
    /// Backlash and end stops.
    Play,
    /// Stiffness or clock rate that changes with time.
    Drift,
    /// Second body on its own spring.
    SecondBody,
    /// External torque that varies with time.
    Forcing,
    /// Constant torque.
    Preload,
    /// Delay and limits of the input.
    Actuator,
    /// Distortions of a value by the sensor.
    Sensor,
    /// Distortions of a timestamp by the logger.
    Stamps,
}

impl EffectClass {
    /// All classes, in the order of results.
    pub(crate) const ALL: [Self; 11] = [
        Self::Friction,
        Self::Restoring,
        Self::Damping,
        Self::Play,
        Self::Drift,
        Self::SecondBody,
        Self::Forcing,
        Self::Preload,
        Self::Actuator,
        Self::Sensor,
        Self::Stamps,
    ];

    /// Returns the identifier used in results.
    pub(crate) const fn id(self) -> &'static str {
        match self {
            Self::Friction => "friction",
            Self::Restoring => "restoring",
            Self::Damping => "damping",
            Self::Play => "play",
            Self::Drift => "drift",
            Self::SecondBody => "second_body",
            Self::Forcing => "forcing",
            Self::Preload => "preload",
            Self::Actuator => "actuator",
            Self::Sensor => "sensor",
            Self::Stamps => "stamps",
        }
    }
}
