//! Result of the reference integrator: motion, events and energy accounts.

use crate::chain::SampledMotion;

/// Kind of an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Happening {
    /// The velocity changed its sign.
    Reversal,
    /// The system came to rest, held by dry friction.
    Stick,
    /// The torque exceeded the holding torque of dry friction.
    BreakAway,
    /// An effect passed to another of its regions.
    Region {
        /// Id of the effect.
        effect: &'static str,
        /// Region left.
        from: i8,
        /// Region entered.
        to: i8,
    },
}

/// Event, located to rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// Time in seconds.
    pub time: f64,
    /// Position at the event, in rad or m.
    pub position: f64,
    /// Velocity at the event, in rad/s or m/s.
    pub velocity: f64,
    /// Kind of the event.
    pub happening: Happening,
}

/// Origin of the work done on the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Worker {
    /// Nominal damping.
    Damping,
    /// Measured input, after gain and delay.
    Input,
    /// Effect, by its id.
    Effect(&'static str),
}

/// Work done on the body since the start, at each requested time.
#[derive(Debug, Clone, PartialEq)]
pub struct Account {
    /// Origin of the work.
    pub worker: Worker,
    /// ∫ torque·velocity dt in joules (per unit of inertia if the system's units are).
    pub work: Vec<f64>,
}

/// Motion at the requested times: each list has one entry for each of these times, except [`Motion::events`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Motion {
    /// Positions in rad or m.
    pub position: Vec<f64>,
    /// Velocities in rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Accelerations in rad/s² or m/s².
    pub acceleration: Vec<f64>,
    /// Events, in order.
    pub events: Vec<Event>,
    /// Work of damping, input and each effect. Together they equal the change of the energy ½·I·θ̇² + ½·k·(θ
    /// − θ_rest)².
    pub accounts: Vec<Account>,
    /// Number of steps taken.
    pub steps: usize,
}

impl Motion {
    /// Returns the motion in the form that a measurement chain takes, at the times in seconds of the
    /// simulation.
    #[must_use]
    pub fn sampled<'a>(&'a self, times_s: &'a [f64]) -> SampledMotion<'a, f64> {
        SampledMotion {
            times_s,
            position: &self.position,
            velocity: &self.velocity,
            acceleration: &self.acceleration,
        }
    }
}
