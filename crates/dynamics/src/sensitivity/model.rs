//! System with free quantities, prepared for many runs.

use super::columns::{Columns, Coupling};
use super::free::{Free, Place, place};
use super::graph::{EFFECTS, Graph, MOST_STATES, NOMINAL};
use super::series::LENGTH;
use crate::description::Range;
use crate::error::DynamicsError;
use crate::field::{Field, Mode};
use crate::law::MOST_PARAMETERS;
use crate::scalar::Rounded;
use crate::system::System;
use serde::{Deserialize, Serialize};

/// Settings of a run: outputs and accuracy.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Error of a step relative to the largest position, velocity and hidden state so far; above 0, 1e-10 by
    /// default.
    pub tolerance: f64,
    /// Degree of the Taylor series, 2 to 19; 14 by default.
    pub degree: usize,
    /// `true` to compute velocities at the samples.
    pub velocity: bool,
    /// `true` to compute accelerations at the samples.
    pub acceleration: bool,
    /// `true` to compute the sensitivities of those velocities and accelerations that are computed. Those of
    /// the position are always computed.
    pub rate_sensitivities: bool,
    /// Maximum number of steps before [`DynamicsError::TooManySteps`].
    pub most_steps: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            tolerance: 1e-10,
            degree: 14,
            velocity: false,
            acceleration: false,
            rate_sensitivities: true,
            most_steps: 1_000_000,
        }
    }
}

/// System with free quantities. It keeps the buffers of a run: later runs allocate nothing.
#[derive(Debug, Clone)]
pub struct Model {
    pub(super) field: Field<f64>,
    /// Field that yields the rounding errors of its rates.
    pub(super) rounded: Field<Rounded>,
    pub(super) directed: bool,
    pub(super) delay: f64,
    pub(super) free: Vec<Place>,
    pub(super) states: usize,
    pub(super) settings: Settings,
    /// Recorded field of each mode met so far.
    pub(super) graphs: Vec<Piece>,
    pub(super) columns: Columns,
    pub(super) couplings: Vec<Coupling>,
    pub(super) shifts: Vec<f64>,
}

/// Recorded field of one mode.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub(super) mode: Mode,
    pub(super) graph: Graph,
    /// `true` if its parameters are those of the field.
    pub(super) current: bool,
}

impl Model {
    /// Creates a model of a system with free quantities, in the order of the columns; the list may be empty.
    ///
    /// # Errors
    /// Returns [`DynamicsError::NotFree`] if a free quantity does not belong to the system, or is named
    /// twice.
    pub fn new(system: &System, free: &[Free], settings: Settings) -> Result<Self, DynamicsError> {
        let mut places = Vec::with_capacity(free.len());
        for (index, quantity) in free.iter().enumerate() {
            if free.iter().take(index).any(|other| other == quantity) {
                let parameter = format!("{quantity:?}");
                return Err(DynamicsError::NotFree { parameter, reason: "it is named twice" });
            }
            places.push(place(system, *quantity)?);
        }
        let field = system.field();
        let states = 2 + system.hidden_states();
        let degree = settings.degree.clamp(2, LENGTH - 1);
        Ok(Self {
            directed: field.directed(),
            rounded: field.over(),
            delay: system.input_delay(),
            states,
            settings: Settings { degree, ..settings },
            graphs: Vec::new(),
            columns: Columns::new(places.len(), states),
            couplings: Vec::with_capacity(MOST_STATES * MOST_STATES),
            shifts: vec![0.0; places.len()],
            free: places,
            field,
        })
    }

    /// Returns the number of columns of every sensitivity: one for each free quantity, in the order given to
    /// the model.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.free.len()
    }

    /// Sets the free parameters: one value for each free quantity that is not a start value, in order.
    ///
    /// Values outside a parameter's physical range are accepted, because a fit that ends there is a finding.
    ///
    /// # Errors
    /// Returns [`DynamicsError::WrongNumberOfValues`], or [`DynamicsError::NominalOutOfRange`] for an inertia
    /// that is not above 0 or a value that is not finite.
    pub fn set(&mut self, values: &[f64]) -> Result<(), DynamicsError> {
        let leaf = |place: &Place| match place {
            Place::Leaf(leaf) | Place::Delay(leaf) => Some(*leaf),
            Place::Start(_) => None,
        };
        let leaves: Vec<usize> = self.free.iter().filter_map(leaf).collect();
        if leaves.len() != values.len() {
            return Err(DynamicsError::WrongNumberOfValues {
                effect: "model",
                expected: leaves.len(),
                found: values.len(),
            });
        }
        for (&leaf, &value) in leaves.iter().zip(values) {
            let range = if leaf == NOMINAL { Range::POSITIVE } else { Range::ANY };
            if !range.contains(value) {
                let parameter = if leaf == NOMINAL { "inertia" } else { "free parameter" };
                return Err(DynamicsError::NominalOutOfRange { parameter, value, range });
            }
        }
        for (&leaf, &value) in leaves.iter().zip(values) {
            if let Some(slot) = self.parameter(leaf) {
                *slot = value;
            }
        }
        self.delay = self.field.input_delay();
        self.rounded = self.field.over();
        for piece in &mut self.graphs {
            piece.current = false;
        }
        Ok(())
    }

    fn parameter(&mut self, leaf: usize) -> Option<&mut f64> {
        let nominal = &mut self.field.nominal;
        match leaf.checked_sub(NOMINAL)? {
            0 => Some(&mut nominal.inertia),
            1 => Some(&mut nominal.damping),
            2 => Some(&mut nominal.stiffness),
            3 => Some(&mut nominal.rest_angle),
            4 => Some(&mut nominal.input_gain),
            _ => {
                let index = leaf - EFFECTS;
                let term = self.field.terms.get_mut(index / MOST_PARAMETERS)?;
                term.values.get_mut(index % MOST_PARAMETERS)
            }
        }
    }

    /// Returns the index of the piece with the field of a mode, which is recorded when first met.
    pub(super) fn piece(&mut self, mode: &Mode) -> usize {
        let known = self.graphs.iter().position(|piece| piece.mode == *mode);
        let number = known.unwrap_or_else(|| {
            let free = &self.free;
            let wanted = |leaf: usize| free.iter().any(|place| place.influences(leaf));
            let graph = Graph::record(&self.field, self.directed, mode, self.states, &wanted);
            self.graphs.push(Piece { mode: *mode, graph, current: false });
            self.graphs.len() - 1
        });
        let field = &self.field;
        if let Some(piece) = self.graphs.get_mut(number).filter(|piece| !piece.current) {
            let nominal = &field.nominal;
            let coefficients =
                [nominal.inertia, nominal.damping, nominal.stiffness, nominal.rest_angle, nominal.input_gain];
            let effects = field.terms.iter().flat_map(|term| term.values);
            for (index, value) in coefficients.into_iter().chain(effects).enumerate() {
                piece.graph.set_leaf(NOMINAL + index, &[value]);
            }
            piece.graph.prepare();
            piece.current = true;
        }
        number
    }
}
