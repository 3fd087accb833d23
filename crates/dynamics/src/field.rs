//! Vector field: the rates of a state under all forces together, on one smooth piece.

use crate::law::{Hidden, MOST_HIDDEN, Moment, Values};
use crate::nominal::Coefficients;
use crate::registry::SystemEffect;
use crate::scalar::Scalar;

/// Maximum number of hidden state variables of a system: those of all effects of the registry together.
pub const SYSTEM_HIDDEN: usize = 4;

/// Maximum number of effects in one system: each of the registry once.
pub(crate) const MOST_EFFECTS: usize = SystemEffect::ALL.len();

/// Smooth piece of the law: direction of motion and the region of each effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mode {
    /// 1 or −1; 0 while the system sticks.
    pub(crate) direction: f64,
    pub(crate) regions: [i8; MOST_EFFECTS],
}

impl Mode {
    pub(crate) fn sticks(&self) -> bool {
        self.direction == 0.0
    }
}

/// State, time and input at one moment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct State<S> {
    pub(crate) time: S,
    pub(crate) position: S,
    pub(crate) velocity: S,
    pub(crate) hidden: [S; SYSTEM_HIDDEN],
    /// Torque of the input after gain and delay, and its rate: see [`Moment::input_rate`].
    pub(crate) input: [S; 2],
}

impl State<f64> {
    /// Converts the state to another scalar type.
    pub(crate) fn over<S: Scalar>(&self) -> State<S> {
        State {
            time: S::from(self.time),
            position: S::from(self.position),
            velocity: S::from(self.velocity),
            hidden: self.hidden.map(S::from),
            input: self.input.map(S::from),
        }
    }
}

/// Effect of a system with its values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Term<S> {
    pub(crate) effect: SystemEffect,
    pub(crate) values: Values<S>,
    /// Index of its first hidden state variable.
    pub(crate) hidden: usize,
}

/// System as a field that can be evaluated over any scalar.
#[derive(Debug, Clone)]
pub(crate) struct Field<S> {
    pub(crate) nominal: Coefficients<S>,
    pub(crate) terms: Vec<Term<S>>,
}

impl Field<f64> {
    /// Returns the delay of the input in seconds; 0 if no effect delays it.
    pub(crate) fn input_delay(&self) -> f64 {
        self.terms.iter().find_map(|term| term.effect.input_delay(&term.values)).unwrap_or(0.0)
    }

    /// Converts the field to another scalar type.
    pub(crate) fn over<S: Scalar>(&self) -> Field<S> {
        let Coefficients { inertia, damping, stiffness, rest_angle, input_gain } = self.nominal;
        let nominal = Coefficients {
            inertia: S::from(inertia),
            damping: S::from(damping),
            stiffness: S::from(stiffness),
            rest_angle: S::from(rest_angle),
            input_gain: S::from(input_gain),
        };
        let terms = self.terms.iter();
        let terms = terms.map(|&Term { effect, values, hidden }| Term {
            effect,
            values: values.map(S::from),
            hidden,
        });
        Field { nominal, terms: terms.collect() }
    }
}

impl<S: Scalar> Term<S> {
    /// Returns the moment that the effect reads.
    #[inline]
    pub(crate) fn moment(
        &self,
        nominal: &Coefficients<S>,
        state: &State<S>,
        direction: f64,
        region: i8,
    ) -> Moment<S> {
        let mut hidden = [S::from(0.0); MOST_HIDDEN];
        for (own, all) in hidden.iter_mut().zip(state.hidden.iter().skip(self.hidden)) {
            *own = *all;
        }
        let [input, input_rate] = state.input;
        Moment {
            time: state.time,
            position: state.position,
            velocity: state.velocity,
            input,
            input_rate,
            hidden,
            nominal: *nominal,
            direction,
            region,
        }
    }
}

impl<S: Scalar> Field<S> {
    /// Returns every effect with the moment that it reads.
    #[inline]
    pub(crate) fn moments(
        &self,
        state: &State<S>,
        mode: &Mode,
    ) -> impl Iterator<Item = (&Term<S>, Moment<S>)> {
        self.terms.iter().zip(mode.regions).map(|(term, region)| {
            let moment = term.moment(&self.nominal, state, mode.direction, region);
            (term, moment)
        })
    }

    /// Returns the nominal damping's torque −c·θ̇.
    #[inline]
    pub(crate) fn damping(&self, state: &State<S>) -> S {
        -self.nominal.damping * state.velocity
    }

    /// Returns the nominal spring's torque −k·(θ − θ_rest).
    #[inline]
    pub(crate) fn spring(&self, state: &State<S>) -> S {
        -self.nominal.stiffness * (state.position - self.nominal.rest_angle)
    }

    /// Returns the sum of all torques. In a mode that sticks dry friction contributes none.
    #[inline]
    pub(crate) fn torque(&self, state: &State<S>, mode: &Mode) -> S {
        let [input, _] = state.input;
        let nominal = self.spring(state) + self.damping(state) + input;
        self.moments(state, mode)
            .fold(nominal, |sum, (term, moment)| sum + term.effect.torque(&term.values, &moment))
    }

    /// Returns the torque up to which dry friction holds a state at rest; `None` without dry friction.
    pub(crate) fn holding_torque(&self, state: &State<S>, mode: &Mode) -> Option<S> {
        let moments = self.moments(state, mode);
        let holding = moments.filter_map(|(term, moment)| term.effect.holding_torque(&term.values, &moment));
        holding.reduce(|sum, torque| sum + torque)
    }

    /// Returns the acceleration and the rates of the hidden state. The acceleration is zero while the system
    /// sticks.
    #[inline]
    pub(crate) fn rates(&self, state: &State<S>, mode: &Mode) -> (S, [S; SYSTEM_HIDDEN]) {
        let acceleration =
            if mode.sticks() { S::from(0.0) } else { self.torque(state, mode) / self.nominal.inertia };
        let mut rates = [S::from(0.0); SYSTEM_HIDDEN];
        for (term, moment) in self.moments(state, mode) {
            let states = term.effect.description().hidden_states;
            if states == 0 {
                continue;
            }
            let own: Hidden<S> = term.effect.hidden_rate(&term.values, &moment);
            for (rate, own) in rates.iter_mut().skip(term.hidden).zip(own).take(states) {
                *rate = own;
            }
        }
        (acceleration, rates)
    }
}
