//! Free quantities and their storage.

use super::graph::{EFFECTS, INPUT, INPUT_RATE, NOMINAL};
use crate::error::DynamicsError;
use crate::field::SYSTEM_HIDDEN;
use crate::law::MOST_PARAMETERS;
use crate::registry::SystemEffect;
use crate::system::System;

/// Quantity that a fit may move: one column of the sensitivities.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Free {
    /// Nominal inertia.
    Inertia,
    /// Nominal damping.
    Damping,
    /// Nominal stiffness.
    Stiffness,
    /// Nominal rest angle.
    RestAngle,
    /// Nominal gain of the input.
    InputGain,
    /// Parameter of an effect of the system, by the effect's id and the parameter's name.
    Effect {
        /// Id of the effect.
        id: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
    },
    /// Position at the start.
    StartPosition,
    /// Velocity at the start.
    StartVelocity,
    /// Hidden state variable at the start, counted from 0 in the order of the system's effects.
    StartHidden(usize),
}

/// Storage of a free quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// Leaf of the recorded field.
    Leaf(usize),
    /// Delay of the input: it shifts the input's time. The leaf keeps its value.
    Delay(usize),
    /// State variable at the start.
    Start(usize),
}

impl Place {
    /// Returns `true` if the derivative with respect to this leaf of the field is needed.
    pub(crate) fn influences(self, leaf: usize) -> bool {
        match self {
            Self::Leaf(own) => own == leaf,
            Self::Delay(_) => leaf == INPUT || leaf == INPUT_RATE,
            Self::Start(_) => false,
        }
    }
}

pub(crate) fn place(system: &System, free: Free) -> Result<Place, DynamicsError> {
    let missing = |parameter: String, reason| Err(DynamicsError::NotFree { parameter, reason });
    Ok(match free {
        Free::Inertia => Place::Leaf(NOMINAL),
        Free::Damping => Place::Leaf(NOMINAL + 1),
        Free::Stiffness => Place::Leaf(NOMINAL + 2),
        Free::RestAngle => Place::Leaf(NOMINAL + 3),
        Free::InputGain => Place::Leaf(NOMINAL + 4),
        Free::StartPosition => Place::Start(0),
        Free::StartVelocity => Place::Start(1),
        Free::StartHidden(index) if index < system.hidden_states().min(SYSTEM_HIDDEN) => {
            Place::Start(2 + index)
        }
        Free::StartHidden(index) => {
            return missing(format!("hidden state {index}"), "the system has fewer hidden states");
        }
        Free::Effect { id, parameter } => {
            let Some((number, active)) =
                system.effects().iter().enumerate().find(|(_, active)| active.id() == id)
            else {
                return missing(format!("{id}.{parameter}"), "the system does not have this effect");
            };
            let Some(index) = active.effect().description().parameter_index(parameter) else {
                return missing(format!("{id}.{parameter}"), "the effect does not have this parameter");
            };
            let leaf = EFFECTS + number * MOST_PARAMETERS + index;
            if id == SystemEffect::InputDelay.description().id {
                Place::Delay(leaf)
            } else {
                Place::Leaf(leaf)
            }
        }
    })
}
