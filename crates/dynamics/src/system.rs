//! System: the nominal oscillator with effects.

use crate::active::Active;
use crate::error::DynamicsError;
use crate::field::{Field, MOST_EFFECTS, Mode, SYSTEM_HIDDEN, State, Term};
use crate::input::{Cubic, Input};
use crate::law::MOST_HIDDEN;
use crate::nominal::Nominal;
use crate::registry::{Effect, SystemEffect};
use crate::scalar::Rounded;
use serde::{Deserialize, Serialize};

/// Nominal oscillator together with effects that act in it.
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

/// Start of a motion, at the first of the requested times.
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
    /// Creates a release from rest.
    #[must_use]
    pub const fn release(position: f64) -> Self {
        Self { position, velocity: 0.0 }
    }

    /// Returns the position beyond which a motion counts as diverging: a hundred thousand times the release,
    /// or that many units.
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
    /// Creates a system from a nominal oscillator and effects; the list may be empty.
    ///
    /// # Errors
    /// Returns [`DynamicsError::Duplicate`] if an effect is given twice, [`DynamicsError::NotInTheSystem`]
    /// for an effect of the measurement chain, and [`DynamicsError::Contradiction`] if parameters contradict
    /// each other.
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

    /// Returns the nominal oscillator.
    #[must_use]
    pub fn nominal(&self) -> &Nominal {
        &self.nominal
    }

    /// Returns the effects, in the order given.
    #[must_use]
    pub fn effects(&self) -> &[Active] {
        &self.effects
    }

    /// Returns the number of hidden state variables of all effects together, such as those of hysteresis and
    /// of a second body.
    #[must_use]
    pub fn hidden_states(&self) -> usize {
        self.effects.iter().map(|active| active.effect().description().hidden_states).sum()
    }

    /// Rejects a release from rest inside the spring's dead zone if nothing else pulls, since nothing would
    /// move.
    ///
    /// # Errors
    /// Returns [`DynamicsError::ReleaseInsideDeadZone`].
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
        let state = State { time: 0.0, position: start.position, velocity: 0.0, hidden, input: [0.0; 2] };
        // The spring's own torque and the part that the dead zone removes cancel, except for rounding.
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

    /// Returns the hidden states at the start of a simulated motion: those given, and the others relaxed.
    pub(crate) fn hidden_at(&self, start: Start) -> [f64; SYSTEM_HIDDEN] {
        let field = self.field();
        let mut hidden = field.relaxed(start.position, start.velocity);
        let acting = self.effects.iter().filter(|active| acting(active).is_ok());
        for (active, term) in acting.zip(&field.terms) {
            let given = active.start().unwrap_or_default();
            hidden.iter_mut().skip(term.hidden).zip(given).for_each(|(slot, state)| *slot = *state);
        }
        hidden
    }

    pub(crate) fn input_delay(&self) -> f64 {
        self.field().input_delay()
    }
}

/// Excess of the torque over the holding torque of dry friction that counts as balance, relative to the
/// latter.
const BALANCE: f64 = 1e-12;

/// Factor on the bound for a torque's rounding error: a series groups its terms differently from the law.
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
    /// Returns `true` if a reversal ends the smooth piece.
    pub(crate) fn directed(&self) -> bool {
        self.terms.iter().any(|term| term.effect.directed())
    }

    /// Returns the hidden state of effects that are relaxed and move along with the body.
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

    /// Returns the mode of a state: moving in its direction or, at rest, in the direction in which the torque
    /// exceeds the holding torque of dry friction.
    pub(crate) fn mode(&self, state: &State<f64>) -> Mode {
        if state.velocity != 0.0 {
            return self.moving(state, state.velocity.signum());
        }
        let stuck = self.moving(state, 0.0);
        let torque = self.torque(state, &stuck);
        match self.holding_torque(state, &stuck) {
            // A balance up to rounding counts as holding; the later terms of the torque show whether the body
            // breaks away.
            Some(holding) if torque.abs() <= holding + self.balance(state) => stuck,
            _ if torque < 0.0 => self.moving(state, -1.0),
            _ => self.moving(state, 1.0),
        }
    }

    /// Returns the amount by which a torque may miss the holding torque of dry friction and still balance it,
    /// in N·m: the remainder of torques that cancel is rounding. At rest only.
    pub(crate) fn balance(&self, state: &State<f64>) -> f64 {
        let stuck = self.moving(state, 0.0);
        let torque = self.over::<Rounded>().torque(&state.over(), &stuck);
        BALANCE * self.holding_torque(state, &stuck).unwrap_or(0.0) + ROUNDING * torque.error
    }

    /// Returns the mode of a state that moves in a direction, or sticks if the direction is 0.
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

    /// Sets hidden states exactly to the values that their regions require.
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

/// Torque of the input as a function of time, one piece after the other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Drive<'a> {
    input: Option<&'a Input>,
    index: usize,
    pub(crate) gain: f64,
    pub(crate) delay: f64,
}

impl<'a> Drive<'a> {
    pub(crate) fn new(input: Option<&'a Input>, gain: f64, delay: f64, time: f64) -> Self {
        let index = input.map_or(0, |input| input.piece_index(time - delay));
        Self { input, index, gain, delay }
    }

    /// Returns the time at which the present piece ends and the next begins.
    pub(crate) fn until(&self) -> f64 {
        self.input.map_or(f64::INFINITY, |input| input.piece(self.index).until + self.delay)
    }

    /// Returns the Taylor coefficients of the raw input at a time on the present piece, and those of its rate; zeros
    /// without an input.
    pub(crate) fn raw(&self, time: f64) -> [Cubic; 2] {
        self.input.map_or([[0.0; 4]; 2], |input| {
            let piece = input.piece(self.index);
            [piece.expanded(time - self.delay), piece.rate_expanded(time - self.delay)]
        })
    }

    /// Returns the torque at a time on the present piece, and its rate.
    pub(crate) fn torque(&self, time: f64) -> [f64; 2] {
        let [[value, ..], [rate, ..]] = self.raw(time);
        [self.gain * value, self.gain * rate]
    }

    pub(crate) fn advance(&mut self) {
        self.index += 1;
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
