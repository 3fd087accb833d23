//! Classes of effects that act alike.

/// Class of effects that act alike: a record tells classes apart more easily than kinds within one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum EvidenceClass {
    /// Dry friction of any kind.
    Friction,
    /// Restoring torque beside the spring's own.
    Restoring,
    /// Law of damping beside the viscous one.
    Damping,
    /// Play and stops.
    Play,
    /// Spring or clock that drifts.
    Drift,
    /// Body coupled by a spring.
    SecondBody,
    /// Torque that repeats in time.
    Forcing,
    /// Constant torque.
    Preload,
    /// Delays and limits of the input.
    Actuator,
    /// Effects of the sensor on values.
    Sensor,
    /// Effects of the host on time stamps.
    Stamps,
    /// Torque without a name: it competes with named effects but is no answer itself.
    Unnamed,
}

impl EvidenceClass {
    /// Returns the public id.
    pub(crate) fn id(self) -> &'static str {
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
            Self::Unnamed => "unknown",
        }
    }
}
