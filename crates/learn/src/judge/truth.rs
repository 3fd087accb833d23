//! Truth of simulated records, available to the judge only.

use crate::data::{DataSet, local_states};
use crate::learners::library::Term;
use crate::linear::least_squares;
use crate::{LearnError, Model, Place};
use dynamics::sensitivity::{FullState, Model as Motion, Settings};
use dynamics::{Hold, Input, NominalSimulator, System};
use nalgebra::{DMatrix, DVector};

/// Learned coefficient and its true value.
#[derive(Debug, Clone, PartialEq)]
pub struct CoefficientError {
    /// Name of the term.
    pub name: String,
    /// True value.
    pub truth: f64,
    /// Learned value; 0 if the law lacks the term.
    pub value: f64,
    /// Error divided by the stated standard error; `None` if none is stated.
    pub std_errors: Option<f64>,
}

/// True accelerations at visited states.
#[derive(Debug, Clone)]
pub struct Truth {
    places: Vec<Place>,
    accelerations: Vec<f64>,
    /// True minus nominal acceleration at each state; the whole true acceleration without a nominal
    /// simulator.
    missing: Vec<f64>,
}

/// Number of states at which the truth is evaluated.
const PLACES: usize = 400;

impl Truth {
    /// Computes the true accelerations of `system` at states visited by the test part; `None` if the
    /// acceleration is not a function of the state (hidden states, laws that depend on time).
    ///
    /// # Errors
    /// [`LearnError::Dynamics`] if the system cannot run.
    pub fn new(system: &System, data: &DataSet) -> Result<Option<Self>, LearnError> {
        let of_time = ["stiffness_drift", "damping_drift", "periodic_forcing", "input_delay"];
        let is_of_time = system.effects().iter().any(|active| of_time.contains(&active.id()));
        if system.hidden_states() > 0 || is_of_time {
            return Ok(None);
        }
        let places = visited(data);
        let accelerations = accelerations(system, &places)?;
        let missing = match &data.nominal {
            None => accelerations.clone(),
            Some(nominal) => {
                let known = accelerations_of(nominal, &places)?;
                accelerations.iter().zip(&known).map(|(truth, known)| truth - known).collect()
            }
        };
        Ok(Some(Self { places, accelerations, missing }))
    }

    /// Returns the root mean square error of a model's torque, divided by the root mean square of the torque
    /// that the nominal simulator lacks; `None` for a model without a torque.
    #[must_use]
    pub fn torque_error(&self, model: &dyn Model) -> Option<f64> {
        let learned: Vec<f64> = self
            .places
            .iter()
            .map(|place| model.torque(place).map(|torque| torque.value))
            .collect::<Option<_>>()?;
        let square = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value * value).sum::<f64>();
        let error = square(&mut learned.iter().zip(&self.accelerations).map(|(a, b)| a - b));
        let size = square(&mut self.missing.iter().copied());
        Some((error / size).sqrt())
    }

    /// Returns one row per state: position, velocity, input, true acceleration, learned acceleration and its
    /// standard deviation (NaN if the model states none).
    #[must_use]
    pub fn rows(&self, model: &dyn Model) -> Vec<[f64; 6]> {
        let row = |(place, truth): (&Place, &f64)| {
            let torque = model.torque(place)?;
            let std = torque.std.unwrap_or(f64::NAN);
            Some([place.position, place.velocity, place.input, *truth, torque.value, std])
        };
        self.places.iter().zip(&self.accelerations).filter_map(row).collect()
    }

    /// Returns the true coefficients of terms, by least squares on the true accelerations; `None` if the
    /// terms do not reproduce these to one part in a million.
    #[must_use]
    pub fn coefficients(&self, terms: &[Term]) -> Option<Vec<(Term, f64)>> {
        let rows: Vec<f64> =
            self.places.iter().flat_map(|place| terms.iter().map(|term| term.value(place))).collect();
        let rows = DMatrix::from_row_slice(self.places.len(), terms.len(), &rows);
        let right = DVector::from_column_slice(&self.accelerations);
        let weights = least_squares(&rows, &right)?;
        let off = (&rows * &weights - &right).norm() / right.norm();
        (off < 1e-6).then(|| terms.iter().cloned().zip(weights.iter().copied()).collect())
    }

    /// Compares learned and true coefficients, for every term that either law has. `None` if the model has no
    /// coefficients, or if the true law is no sum of known terms.
    #[must_use]
    pub fn coefficient_errors(&self, model: &dyn Model) -> Option<Vec<CoefficientError>> {
        if model.coefficients().is_empty() {
            return None;
        }
        let has_input = self.places.iter().any(|place| place.input != 0.0);
        let terms: Vec<Term> =
            Term::ALL.into_iter().filter(|term| *term != Term::Input || has_input).collect();
        let truth = self.coefficients(&terms)?;
        let largest = self.accelerations.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let errors = truth.into_iter().filter_map(|(term, truth)| {
            let learned = model.coefficients().iter().find(|own| own.name == term.name());
            let negligible = truth.abs() < 1e-6 * largest;
            if negligible && learned.is_none() {
                return None;
            }
            let value = learned.map_or(0.0, |own| own.value);
            let truth = if negligible { 0.0 } else { truth };
            let std_errors = learned.and_then(|own| own.std_error).map(|error| (value - truth) / error);
            Some(CoefficientError { name: term.name().into_owned(), truth, value, std_errors })
        });
        Some(errors.collect())
    }
}

/// Returns evenly chosen states of the test part.
fn visited(data: &DataSet) -> Vec<Place> {
    let states: Vec<_> = data.test.iter().flat_map(|part| local_states(part, data.period_s / 8.0)).collect();
    let stride = (states.len() / PLACES).max(1);
    let place = |state: &crate::data::LocalState| Place {
        position: state.position,
        velocity: state.velocity,
        direction: state.velocity.signum(),
        input: state.input,
    };
    states.iter().step_by(stride).map(place).collect()
}

/// Returns the acceleration of a system at states.
fn accelerations(system: &System, places: &[Place]) -> Result<Vec<f64>, LearnError> {
    let settings = Settings { velocity: true, acceleration: true, ..Settings::default() };
    let mut model = Motion::new(system, &[], settings)?;
    let at = |place: &Place| -> Result<f64, LearnError> {
        let start = FullState { position: place.position, velocity: place.velocity, hidden: None };
        let input = Input::new(vec![0.0], vec![place.input], Hold::Zero)?;
        let found = model.run(start, Some(&input), &[0.0])?;
        Ok(found.acceleration.first().copied().unwrap_or(f64::NAN))
    };
    places.iter().map(at).collect()
}

/// Returns the acceleration of a nominal simulator at states; its measurement chain causes no torque.
fn accelerations_of(nominal: &NominalSimulator, places: &[Place]) -> Result<Vec<f64>, LearnError> {
    accelerations(&crate::baselines::system_of(nominal)?, places)
}
