//! Classes of effects that explain alike.

/// A class of effects that explain alike: a record tells classes apart before it tells kinds within one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum EvidenceClass {
    /// Dry friction of any kind.
    Friction,
    /// A restoring torque beside the spring's own.
    Restoring,
    /// A law of damping beside the viscous one.
    Damping,
    /// Play and stops.
    Play,
    /// A spring or a clock that drifts.
    Drift,
    /// A body tied on by a spring.
    SecondBody,
    /// A torque that repeats in time.
    Forcing,
    /// A constant torque.
    Preload,
    /// Delays and limits of the input.
    Actuator,
    /// What the sensor does to values.
    Sensor,
    /// What the host does to time stamps.
    Stamps,
    /// A torque without a name: it takes the place of others, and is no answer itself.
    Unnamed,
}

impl EvidenceClass {
    /// The public id.
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
