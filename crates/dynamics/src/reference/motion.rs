//! What the reference integrator gives.

use crate::chain::SampledMotion;

/// Kind of an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Happening {
    /// The velocity changed its sign.
    Reversal,
    /// The system came to rest, held by dry friction.
    Stick,
    /// The torque overcame the dry friction's hold.
    BreakAway,
    /// An effect passed to another of its regions.
    Region {
        /// The effect's id.
        effect: &'static str,
        /// The region left.
        from: i8,
        /// The region entered.
        to: i8,
    },
}

/// An event, located to rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// When, in seconds.
    pub time: f64,
    /// Position there.
    pub position: f64,
    /// Velocity there.
    pub velocity: f64,
    /// Kind of the event.
    pub happening: Happening,
}

/// Who does work on the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Worker {
    /// The nominal damping.
    Damping,
    /// The measured input, after gain and delay.
    Input,
    /// An effect, by its id.
    Effect(&'static str),
}

/// Work done on the body since the start, at each time asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Account {
    /// Who does it.
    pub worker: Worker,
    /// ∫ torque·velocity dt in joules (per unit of inertia where the system is).
    pub work: Vec<f64>,
}

/// A motion at the times asked for: each list has one entry for each of these times, but for [`Motion::events`].
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
    /// The work of damping, input and each effect. Together it is the change of the energy
    /// ½·I·θ̇² + ½·k·(θ − θ_rest)².
    pub accounts: Vec<Account>,
    /// Steps taken.
    pub steps: usize,
}

impl Motion {
    /// The motion as a measuring chain takes it, at the times in seconds that it was simulated for.
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
