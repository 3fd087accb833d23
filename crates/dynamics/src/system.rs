//! A system: the nominal oscillator with effects.

use crate::active::Active;
use crate::error::DynamicsError;
use crate::field::{Field, MOST_EFFECTS, Mode, SYSTEM_HIDDEN, State, Term};
use crate::input::Input;
use crate::law::MOST_HIDDEN;
use crate::nominal::Nominal;
use crate::registry::{Effect, SystemEffect};
use crate::scalar::Rounded;
use serde::{Deserialize, Serialize};

/// A nominal oscillator together with effects that act in it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Raw", into = "Raw")]
pub struct System {
    nominal: Nominal,
    effects: Vec<Active>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    nominal: Nominal,
    #[serde(default)]
    effects: Vec<Active>,
}

/// Where a motion starts, at the first of the times asked for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// Position in rad or m.
    pub position: f64,
    /// Velocity in rad/s or m/s.
    #[serde(default)]
    pub velocity: f64,
}

impl Start {
    /// A release from rest.
    #[must_use]
    pub const fn release(position: f64) -> Self {
        Self { position, velocity: 0.0 }
    }

    /// Position beyond which a motion counts as running away: a hundred thousand times the release, or that many
    /// units.
    pub(crate) fn bound(&self) -> f64 {
        1e5 * self.position.abs().max(1.0)
    }

    pub(crate) fn check(&self) -> Result<(), DynamicsError> {
        for (what, value) in [("position", self.position), ("velocity", self.velocity)] {
            if !value.is_finite() {
                return Err(DynamicsError::BadStart { what, value });
            }
        }
        Ok(())
    }
}

impl System {
    /// A nominal oscillator with effects; none is legal.
    ///
    /// # Errors
    /// [`DynamicsError::Duplicate`] where an effect is given twice, [`DynamicsError::NotInTheSystem`] for an
    /// effect of the measuring chain, [`DynamicsError::Contradiction`] where parameters contradict each
    /// other.
    pub fn new(nominal: Nominal, effects: Vec<Active>) -> Result<Self, DynamicsError> {
        for (index, active) in effects.iter().enumerate() {
            let effect = acting(active)?;
            if effects.iter().take(index).any(|other| other.effect() == active.effect()) {
                return Err(DynamicsError::Duplicate { effect: active.id() });
            }
            effect.check(&active.all_values(), &nominal)?;
        }
        Ok(Self { nominal, effects })
    }

    /// The nominal oscillator.
    #[must_use]
    pub fn nominal(&self) -> &Nominal {
        &self.nominal
    }

    /// The effects, in the order given.
    #[must_use]
    pub fn effects(&self) -> &[Active] {
        &self.effects
    }

    /// Number of hidden state variables of all effects together, such as the states of hysteresis and of a second body.
    #[must_use]
    pub fn hidden_states(&self) -> usize {
        self.effects.iter().map(|active| active.effect().description().hidden_states).sum()
    }

    /// Refuses a release from rest inside the dead zone of the spring where nothing else pulls: nothing would
    /// move.
    ///
    /// # Errors
    /// [`DynamicsError::ReleaseInsideDeadZone`].
    pub fn check_release(&self, start: Start) -> Result<(), DynamicsError> {
        let effect = |wanted: SystemEffect| {
            self.effects.iter().find(|active| active.effect() == Effect::System(wanted))
        };
        let Some(half_width) = effect(SystemEffect::Backlash).and_then(|active| active.value("half_width"))
        else {
            return Ok(());
        };
        let release = (start.position - self.nominal.rest_angle()).abs();
        if start.velocity != 0.0 || release > half_width || effect(SystemEffect::PeriodicForcing).is_some() {
            return Ok(());
        }
        let field = self.field();
        let hidden = field.relaxed(start.position, start.velocity);
        let state = State { time: 0.0, position: start.position, velocity: 0.0, hidden, input: 0.0 };
        // The spring's own torque and what the dead zone takes off it cancel, but for rounding.
        let spring = field.spring(&state).abs();
        if field.torque(&state, &field.moving(&state, 0.0)).abs() <= 1e-12 * spring {
            return Err(DynamicsError::ReleaseInsideDeadZone { half_width, release });
        }
        Ok(())
    }

    pub(crate) fn field(&self) -> Field<f64> {
        let mut hidden = 0;
        let mut terms = Vec::with_capacity(self.effects.len());
        for active in &self.effects {
            if let Ok(effect) = acting(active) {
                terms.push(Term { effect, values: active.all_values(), hidden });
                hidden += effect.description().hidden_states;
            }
        }
        Field { nominal: self.nominal.coefficients(), terms }
    }

    pub(crate) fn input_delay(&self) -> f64 {
        // Without the effect the input arrives at once.
        self.field().terms.iter().find_map(|term| term.effect.input_delay(&term.values)).unwrap_or(0.0)
    }
}

/// Excess of the torque over the dry friction's hold that counts as balance, relative to the hold.
const BALANCE: f64 = 1e-12;

/// How many times the bound on its rounding a torque may be off: a series groups its terms otherwise than the law does.
pub(crate) const ROUNDING: f64 = 4.0;

fn acting(active: &Active) -> Result<SystemEffect, DynamicsError> {
    match active.effect() {
        Effect::System(effect) => Ok(effect),
        Effect::MeasuringChain(effect) => {
            Err(DynamicsError::NotInTheSystem { effect: effect.description().id })
        }
    }
}

impl Field<f64> {
    /// Whether a reversal ends the smooth piece.
    pub(crate) fn directed(&self) -> bool {
        self.terms.iter().any(|term| term.effect.directed())
    }

    /// The hidden state of effects that are relaxed and move along with the body.
    pub(crate) fn relaxed(&self, position: f64, velocity: f64) -> [f64; SYSTEM_HIDDEN] {
        let mut hidden = [0.0; SYSTEM_HIDDEN];
        for term in &self.terms {
            let own: [f64; MOST_HIDDEN] = term.effect.relaxed(position, velocity);
            let states = term.effect.description().hidden_states;
            for (slot, own) in hidden.iter_mut().skip(term.hidden).zip(own).take(states) {
                *slot = own;
            }
        }
        hidden
    }

    /// The mode that a state is in, about to move in its direction of motion or, at rest, where the torque
    /// pushes it beyond the dry friction's hold.
    pub(crate) fn mode(&self, state: &State<f64>) -> Mode {
        if state.velocity != 0.0 {
            return self.moving(state, state.velocity.signum());
        }
        let stuck = self.moving(state, 0.0);
        let torque = self.torque(state, &stuck);
        match self.holding_torque() {
            // A balance to rounding holds: whether it is about to break is seen from how the torque goes on.
            Some(holding) if torque.abs() <= holding + self.balance(state) => stuck,
            _ if torque < 0.0 => self.moving(state, -1.0),
            _ => self.moving(state, 1.0),
        }
    }

    /// By how much a torque may miss the dry friction's hold and still be in balance with it, in N·m: what is left of
    /// torques that cancel is rounding. At rest only.
    pub(crate) fn balance(&self, state: &State<f64>) -> f64 {
        let torque = self.over::<Rounded>().torque(&state.over(), &self.moving(state, 0.0));
        // Without dry friction nothing is held, and only rounding is left.
        BALANCE * self.holding_torque().unwrap_or(0.0) + ROUNDING * torque.error
    }

    /// The mode of a state that moves in a direction, or sticks where that is 0.
    pub(crate) fn moving(&self, state: &State<f64>, direction: f64) -> Mode {
        Mode { direction, regions: self.regions(state, direction) }
    }

    fn regions(&self, state: &State<f64>, direction: f64) -> [i8; MOST_EFFECTS] {
        let mut regions = [0; MOST_EFFECTS];
        for (region, term) in regions.iter_mut().zip(&self.terms) {
            let moment = term.moment(&self.nominal, state, direction, 0);
            *region = term.effect.region(&term.values, &moment);
        }
        regions
    }

    /// Puts hidden states exactly where their regions demand.
    pub(crate) fn settle(&self, mode: &Mode, hidden: &mut [f64; SYSTEM_HIDDEN]) {
        for (term, &region) in self.terms.iter().zip(&mode.regions) {
            let states = term.effect.description().hidden_states;
            let mut own = [0.0; MOST_HIDDEN];
            for (own, all) in own.iter_mut().zip(hidden.iter().skip(term.hidden)) {
                *own = *all;
            }
            let settled = term.effect.settle(region, mode.direction, own);
            for (slot, settled) in hidden.iter_mut().skip(term.hidden).zip(settled).take(states) {
                *slot = settled;
            }
        }
    }
}

/// The input's torque as a function of time, one piece after the other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Drive<'a> {
    input: Option<&'a Input>,
    index: usize,
    pub(crate) gain: f64,
    pub(crate) delay: f64,
}

impl<'a> Drive<'a> {
    pub(crate) fn new(input: Option<&'a Input>, gain: f64, delay: f64, time: f64) -> Self {
        // Without an input there is no piece to count.
        let index = input.map_or(0, |input| input.piece_index(time - delay));
        Self { input, index, gain, delay }
    }

    /// Time at which the present piece ends, and the next begins.
    pub(crate) fn until(&self) -> f64 {
        self.input.map_or(f64::INFINITY, |input| input.piece(self.index).until + self.delay)
    }

    /// Raw input value and slope at a time on the present piece.
    pub(crate) fn raw(&self, time: f64) -> (f64, f64) {
        self.input.map_or((0.0, 0.0), |input| {
            let piece = input.piece(self.index);
            (piece.at(time - self.delay), piece.slope)
        })
    }

    /// Torque at a time on the present piece.
    pub(crate) fn torque(&self, time: f64) -> f64 {
        self.gain * self.raw(time).0
    }

    pub(crate) fn advance(&mut self) {
        self.index += 1;
    }

    pub(crate) fn is_present(&self) -> bool {
        self.input.is_some()
    }
}

impl TryFrom<Raw> for System {
    type Error = DynamicsError;

    fn try_from(raw: Raw) -> Result<Self, DynamicsError> {
        Self::new(raw.nominal, raw.effects)
    }
}

impl From<System> for Raw {
    fn from(system: System) -> Self {
        Self { nominal: system.nominal, effects: system.effects }
    }
}
