//! Effect with values for its parameters.

use crate::error::DynamicsError;
use crate::law::{Hidden, MOST_HIDDEN, MOST_PARAMETERS, Values};
use crate::registry::Effect;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Effect of the registry with values for its parameters, each within its range.
///
/// In TOML: `{ id = "coulomb_friction", parameters = { torque = 7e-5 } }`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Raw", into = "Raw")]
pub struct Active {
    effect: Effect,
    values: Values<f64>,
    start: Option<Hidden<f64>>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    id: String,
    #[serde(default)]
    parameters: BTreeMap<String, f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    start: Option<Vec<f64>>,
}

impl Active {
    /// Creates an effect from its public id, with values in the order of its description.
    ///
    /// # Errors
    /// Returns [`DynamicsError::UnknownEffect`], [`DynamicsError::WrongNumberOfValues`], or
    /// [`DynamicsError::OutOfRange`].
    pub fn new(id: &str, values: &[f64]) -> Result<Self, DynamicsError> {
        Self::of(Effect::find(id)?, values)
    }

    /// Creates an effect with values in the order of its description. The last values may be omitted if they
    /// have a default.
    ///
    /// # Errors
    /// Returns [`DynamicsError::WrongNumberOfValues`] or [`DynamicsError::OutOfRange`].
    pub fn of(effect: Effect, values: &[f64]) -> Result<Self, DynamicsError> {
        let description = effect.description();
        let needed = description.parameters.iter().filter(|parameter| parameter.default.is_none()).count();
        if !(needed..=description.parameters.len()).contains(&values.len()) {
            return Err(DynamicsError::WrongNumberOfValues {
                effect: description.id,
                expected: description.parameters.len(),
                found: values.len(),
            });
        }
        let mut own = [0.0; MOST_PARAMETERS];
        let defaults =
            description.parameters.iter().skip(values.len()).filter_map(|parameter| parameter.default);
        let values = values.iter().copied().chain(defaults);
        for ((own, value), parameter) in own.iter_mut().zip(values).zip(description.parameters) {
            if !parameter.range.contains(value) {
                return Err(DynamicsError::OutOfRange {
                    effect: description.id,
                    parameter: parameter.name,
                    value,
                    range: parameter.range,
                });
            }
            *own = value;
        }
        Ok(Self { effect, values: own, start: None })
    }

    /// Returns the effect with its hidden states at the start of a simulated motion, in the order of its law and in SI
    /// units; without them it starts relaxed and moves along. A diagnosis fits its own.
    ///
    /// # Errors
    /// Returns [`DynamicsError::WrongNumberOfStates`], or [`DynamicsError::BadStart`] if one is not finite.
    pub fn starting_at(self, states: &[f64]) -> Result<Self, DynamicsError> {
        let description = self.effect.description();
        if states.len() != description.hidden_states {
            return Err(DynamicsError::WrongNumberOfStates {
                effect: description.id,
                expected: description.hidden_states,
                found: states.len(),
            });
        }
        if let Some(&value) = states.iter().find(|value| !value.is_finite()) {
            return Err(DynamicsError::BadStart { what: "hidden state", value });
        }
        let mut start = [0.0; MOST_HIDDEN];
        start.iter_mut().zip(states).for_each(|(slot, state)| *slot = *state);
        Ok(Self { start: Some(start), ..self })
    }

    /// Creates an effect from its public id, with values by name.
    ///
    /// # Errors
    /// Returns [`DynamicsError::UnknownEffect`], [`DynamicsError::UnknownParameter`],
    /// [`DynamicsError::MissingParameter`], or [`DynamicsError::OutOfRange`].
    pub fn named(id: &str, parameters: &[(&str, f64)]) -> Result<Self, DynamicsError> {
        let effect = Effect::find(id)?;
        let description = effect.description();
        if let Some((name, _)) =
            parameters.iter().find(|(name, _)| description.parameter_index(name).is_none())
        {
            return Err(DynamicsError::UnknownParameter {
                effect: description.id,
                parameter: (*name).to_owned(),
                known: description.parameters.iter().map(|parameter| parameter.name).collect(),
            });
        }
        let values = description
            .parameters
            .iter()
            .map(|parameter| {
                let given =
                    parameters.iter().find(|(name, _)| *name == parameter.name).map(|(_, value)| *value);
                given.or(parameter.default).ok_or(DynamicsError::MissingParameter {
                    effect: description.id,
                    parameter: parameter.name,
                    meaning: parameter.meaning,
                    range: parameter.range,
                })
            })
            .collect::<Result<Vec<_>, _>>()?;
        Self::of(effect, &values)
    }

    /// Returns the effect.
    #[must_use]
    pub fn effect(&self) -> Effect {
        self.effect
    }

    /// Returns the public id.
    #[must_use]
    pub fn id(&self) -> &'static str {
        self.effect.id()
    }

    /// Returns the values, in the order and the units of the description's parameters.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        let count = self.effect.description().parameters.len();
        debug_assert!(count <= MOST_PARAMETERS, "{} has {count} parameters", self.id());
        self.values.get(..count).unwrap_or(&self.values)
    }

    /// Returns the value of a parameter by its name, in the unit of the description; `None` if the effect has
    /// no such parameter.
    #[must_use]
    pub fn value(&self, parameter: &str) -> Option<f64> {
        let index = self.effect.description().parameter_index(parameter)?;
        self.values.get(index).copied()
    }

    /// Returns the hidden states at the start of a simulated motion, if they are given.
    #[must_use]
    pub fn start(&self) -> Option<&[f64]> {
        self.start.as_ref().and_then(|states| states.get(..self.effect.description().hidden_states))
    }

    pub(crate) fn all_values(&self) -> Values<f64> {
        self.values
    }
}

impl TryFrom<Raw> for Active {
    type Error = DynamicsError;

    fn try_from(raw: Raw) -> Result<Self, DynamicsError> {
        let parameters: Vec<(&str, f64)> =
            raw.parameters.iter().map(|(name, &value)| (name.as_str(), value)).collect();
        let active = Self::named(&raw.id, &parameters)?;
        raw.start.map_or(Ok(active), |states| active.starting_at(&states))
    }
}

impl From<Active> for Raw {
    fn from(active: Active) -> Self {
        let names = active.effect.description().parameters.iter().map(|parameter| parameter.name.to_owned());
        Self {
            id: active.id().to_owned(),
            parameters: names.zip(active.values().iter().copied()).collect(),
            start: active.start().map(<[f64]>::to_vec),
        }
    }
}
