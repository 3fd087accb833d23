//! Classes of effects that explain alike.

/// Effects that explain alike: scores of composite cases go by class.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum EffectClass {
    /// Dry friction and hysteresis.
    Friction,
    /// Springs that bend, weights.
    Restoring,
    /// Drag and damping that changes.
    Damping,
    /// Play and stops.
    Play,
    /// Stiffness or clock that changes with time.
    Drift,
    /// A body on a spring of its own.
    SecondBody,
    /// A torque from outside.
    Forcing,
    /// A torque that does not change.
    Preload,
    /// Delay and limits of the input.
    Actuator,
    /// What a sensor does to a value.
    Sensor,
    /// What a logger does to a stamp.
    Stamps,
}

impl EffectClass {
    /// Every class, in the order of results.
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

    /// Its id in results.
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
