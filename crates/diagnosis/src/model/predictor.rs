//! Predictions of a hypothesis for a segment, with exact derivatives.

#![allow(
    clippy::indexing_slicing,
    reason = "series and Jacobians have a row for every sample of their segment, of which there is at least one"
)]

use crate::data::scales::Scales;
use crate::data::segments::{Data, Segment};
use crate::model::candidate::Candidate;
use crate::model::contact::{Bent, bent};
use crate::model::encoder_hysteresis::readings;
use crate::model::hypothesis::{Calibrated, Hypothesis, Source};
use crate::model::lag::Lag;
use crate::model::seen::Seen;
use crate::model::sensor::{Observed, Sensor};
use dynamics::DynamicsError;
use dynamics::sensitivity::{Free, FullState, Model, Response, Settings};
use nalgebra::{DMatrix, DVector};
use record::Quantity;

/// Degree of the Taylor series. At tolerances near a thousandth of the noise, fewer products per step matter
/// more than longer steps (measured on records with friction: 14 takes a fifth longer, 10 half as long
/// again).
const DEGREE: usize = 12;

/// Number of steps, per segment and per sample, beyond which the motion chatters rather than swings; a fit
/// turns back there.
const MOST_STEPS: usize = 400;
const MOST_STEPS_PER_SAMPLE: usize = 3;

/// Quantities that a prediction is differentiated by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Derivatives {
    None,
    /// The segment's own start state.
    Starts,
    /// The start state and every global parameter.
    All,
}

/// Hypothesis prepared for runs.
pub(crate) struct Simulator<'a> {
    data: &'a Data,
    hypothesis: &'a Hypothesis,
    sources: Vec<Source>,
    /// Point that the model is set to.
    point: Vec<f64>,
    measurement: Sensor,
    model: Model,
    response: Response,
    /// Column of each global parameter in the response; `None` for those of the sensor.
    columns: Vec<Option<usize>>,
    contact: Option<Contact>,
    derivatives: Derivatives,
    times: Vec<f64>,
}

/// Contact that bends before it slides: the index of its effect among all, that of its hidden state, and the
/// hidden state's column in the response.
#[derive(Debug, Clone, Copy)]
struct Contact {
    effect: usize,
    /// Index of the displacement among the effect's parameters.
    displacement: usize,
    hidden: usize,
    column: Option<usize>,
}

/// Prediction for a segment.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Prediction {
    /// Observed minus predicted values.
    pub(crate) residual: DVector<f64>,
    /// ∂predicted/∂(start state, global parameters); no columns if no derivatives were requested.
    pub(crate) jacobian: DMatrix<f64>,
}

impl Prediction {
    /// Returns the mean square of the residual.
    pub(crate) fn mean_square(&self) -> f64 {
        self.residual.norm_squared() / self.residual.len().max(1) as f64
    }
}

/// Motion along a segment.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Motion {
    pub(crate) position: Vec<f64>,
    pub(crate) velocity: Vec<f64>,
    pub(crate) acceleration: Vec<f64>,
}

/// Returns the free quantities that a motion is differentiated by, and the index of each global parameter
/// among them.
fn free_parameters(
    hypothesis: &Hypothesis,
    sources: &[Source],
    contact: Option<&mut Contact>,
    derivatives: Derivatives,
) -> (Vec<Free>, Vec<Option<usize>>) {
    let mut free = Vec::new();
    let mut columns = vec![None; sources.len()];
    if derivatives != Derivatives::None {
        free.extend([Free::StartPosition, Free::StartVelocity]);
        free.extend(hidden(hypothesis).map(Free::StartHidden));
        if let Some(contact) = contact {
            contact.column = Some(free.len());
            free.push(Free::StartHidden(contact.hidden));
        }
    }
    if derivatives == Derivatives::All {
        for (source, column) in sources.iter().zip(&mut columns) {
            let own = match *source {
                Source::Nominal(which) => which.free(),
                Source::Effect(index, parameter) => {
                    let effect = hypothesis.effect(index).and_then(Candidate::system);
                    effect.and_then(|effect| {
                        let description = effect.description();
                        let own = description.parameters.get(parameter)?;
                        Some(Free::Effect { id: description.id, parameter: own.name })
                    })
                }
            };
            *column = own.map(|own| {
                free.push(own);
                free.len() - 1
            });
        }
    }
    (free, columns)
}

impl<'a> Simulator<'a> {
    pub(crate) fn new(
        data: &'a Data,
        hypothesis: &'a Hypothesis,
        point: &[f64],
        derivatives: Derivatives,
    ) -> Result<Self, DynamicsError> {
        let facts = &data.facts;
        let sources = hypothesis.sources(facts);
        let measurement = hypothesis.measurement(facts, point);
        let mut contact = contact(hypothesis);
        let (free, columns) = free_parameters(hypothesis, &sources, contact.as_mut(), derivatives);
        let curved = measurement.lag.is_some() || measurement.reading.is_some();
        // The limit counts sampling intervals, not samples: a drive's input has a knot at each, however few
        // samples are fitted.
        let longest = data.longest_span() / facts.interval;
        let settings = Settings {
            tolerance: facts.tolerance,
            velocity: true,
            acceleration: curved || derivatives == Derivatives::None || data.quantity != Quantity::Position,
            rate_sensitivities: measurement.lag.is_some() || data.quantity != Quantity::Position,
            most_steps: MOST_STEPS + MOST_STEPS_PER_SAMPLE * longest as usize,
            degree: DEGREE,
        };
        let system = hypothesis.system(facts, point)?;
        let model = Model::new(&system, &free, settings)?;
        Ok(Self {
            data,
            hypothesis,
            sources,
            point: point.to_vec(),
            measurement,
            model,
            response: Response::default(),
            columns,
            contact,
            derivatives,
            times: Vec::new(),
        })
    }

    fn facts(&self) -> &Scales {
        &self.data.facts
    }

    /// Moves to another point. Only a simulator with all derivatives has free parameters; any other one must
    /// be given the point that it was made for.
    pub(crate) fn set(&mut self, point: &[f64]) -> Result<(), DynamicsError> {
        let mut values = Vec::new();
        let parts = self.hypothesis.all_parts(self.facts(), point);
        for (source, column) in self.sources.iter().zip(&self.columns) {
            match (*source, column) {
                (_, None) => {}
                (Source::Nominal(which), _) => {
                    let at = self.hypothesis.calibrated.iter().position(|own| *own == which);
                    values.extend(at.and_then(|at| point.get(at)));
                }
                (Source::Effect(index, parameter), _) => {
                    let own = parts.get(index).map(|(effect, _, part)| effect.values(part));
                    values.extend(own.and_then(|own| own.get(parameter).copied()));
                }
            }
        }
        self.model.set(&values)?;
        self.point = point.to_vec();
        self.measurement = self.hypothesis.measurement(self.facts(), point);
        Ok(())
    }

    fn run(&mut self, segment: &Segment, start: &[f64]) -> Result<(), DynamicsError> {
        self.times.clear();
        self.times.extend(segment.times.iter().map(|time| self.measurement.true_time(*time)));
        let state = self.state(segment, start);
        let input = self.data.inputs.get(segment.record).and_then(Option::as_ref);
        self.model.run_into(state, input, &self.times, &mut self.response)
    }

    /// Returns the full state at a segment's start. Hidden states that are not fitted are relaxed at the
    /// start of a record; later a contact has the deflection of a steady swing of the same amplitude.
    fn state(&self, segment: &Segment, start: &[f64]) -> FullState {
        let (position, velocity, own) = match start {
            [position, velocity, own @ ..] => (*position, *velocity, own),
            _ => (0.0, 0.0, start),
        };
        let mut all = [0.0; dynamics::SYSTEM_HIDDEN];
        for (index, value) in hidden(self.hypothesis).zip(own) {
            if let Some(slot) = all.get_mut(index) {
                *slot = *value;
            }
        }
        if let Some((contact, bent)) = self.contact.zip(self.bent(segment, start))
            && let Some(slot) = all.get_mut(contact.hidden)
        {
            *slot = bent.z;
        }
        let any = self.contact.is_some() || hidden(self.hypothesis).next().is_some();
        FullState { position, velocity, hidden: any.then_some(all) }
    }

    /// Returns the contact's deflection at a segment's start; `None` without a contact or at the start of the
    /// record.
    fn bent(&self, segment: &Segment, start: &[f64]) -> Option<Bent> {
        let contact = self.contact.filter(|_| !segment.first)?;
        let parts = self.hypothesis.all_parts(self.facts(), &self.point);
        let &displacement = parts.get(contact.effect)?.2.get(contact.displacement)?;
        let &[position, velocity, ..] = start else { return None };
        let deflection = position - self.facts().rest(&self.point, self.hypothesis);
        Some(bent(deflection, velocity / self.facts().frequency, displacement))
    }

    /// Returns the columns of the Jacobian that a contact's hidden state at a segment's start depends on,
    /// with the state's derivatives by them.
    fn bends_by(&self, segment: &Segment, start: &[f64]) -> Vec<(usize, f64)> {
        let Some((contact, bent)) = self.contact.zip(self.bent(segment, start)) else { return Vec::new() };
        let mut all = vec![(0, bent.by_deflection), (1, bent.by_quadrature / self.facts().frequency)];
        if self.derivatives == Derivatives::All {
            let starts = self.hypothesis.start_length();
            let number = |own: Source| self.sources.iter().position(|source| *source == own);
            let by_rest = number(Source::Nominal(Calibrated::RestAngle));
            all.extend(by_rest.map(|number| (starts + number, -bent.by_deflection)));
            let by_displacement = number(Source::Effect(contact.effect, contact.displacement));
            all.extend(by_displacement.map(|number| (starts + number, bent.by_displacement)));
        }
        all
    }

    /// Predicts a segment from a start state.
    pub(crate) fn predict(&mut self, segment: &Segment, start: &[f64]) -> Result<Prediction, DynamicsError> {
        self.run(segment, start)?;
        let starts = self.hypothesis.start_length();
        let width = match self.derivatives {
            Derivatives::None => 0,
            Derivatives::Starts => starts,
            Derivatives::All => starts + self.sources.len(),
        };
        let count = segment.times.len();
        let mut residual = DVector::zeros(count);
        let mut jacobian = DMatrix::zeros(count, width);
        let mut seen = Seen::new(&self.response, self.data.quantity);
        if let Some(constant) = self.measurement.lag {
            let lag = Lag::new(constant, &self.times, self.facts().frequency);
            seen = seen.through(&lag, self.derivatives == Derivatives::All);
        }
        let bends_by = self.bends_by(segment, start);
        let start_time = segment.start_s();
        for (row, (&value, &time)) in segment.values.iter().zip(&segment.times).enumerate() {
            let (x, rate) = seen.at(row);
            let observed = self.measurement.observe(x, rate, time, start_time);
            residual[row] = value - observed.value;
            if self.derivatives != Derivatives::None {
                self.differentiate(row, starts, &seen, &observed, &mut jacobian);
                self.bend(row, &seen, &observed, &bends_by, &mut jacobian);
            }
        }
        // At rest the readings do not tell the direction of the motion before.
        if !segment.still {
            self.hold(segment, &mut residual, &mut jacobian);
        }
        self.combine(&mut jacobian, starts);
        Ok(Prediction { residual, jacobian })
    }

    /// Fills a row of the Jacobian: the derivatives by the `starts` start values, then those by the global
    /// parameters.
    fn differentiate(
        &self,
        row: usize,
        starts: usize,
        seen: &Seen<'_>,
        observed: &Observed,
        jacobian: &mut DMatrix<f64>,
    ) {
        for column in 0..starts {
            jacobian[(row, column)] = observed.slope * seen.by(row, column);
        }
        let own = if self.derivatives == Derivatives::All { self.sources.as_slice() } else { &[] };
        for (number, (source, column)) in own.iter().zip(&self.columns).enumerate() {
            let value = match (column, *source) {
                (Some(column), _) => observed.slope * seen.by(row, *column),
                (None, Source::Effect(index, parameter)) => {
                    let effect = self.hypothesis.effect(index);
                    let which = effect.and_then(|effect| effect.sensor_derivative(parameter));
                    let Some(which) = which else { continue };
                    observed.by_parameter[which]
                }
                (None, Source::Nominal(_)) => continue,
            };
            jacobian[(row, starts + number)] = value;
        }
    }

    /// Adds the derivatives by way of the contact's deflection at the segment's start.
    fn bend(
        &self,
        row: usize,
        seen: &Seen<'_>,
        observed: &Observed,
        bends_by: &[(usize, f64)],
        jacobian: &mut DMatrix<f64>,
    ) {
        let Some(column) = self.contact.and_then(|contact| contact.column) else { return };
        let moved = observed.slope * seen.by(row, column);
        for &(column, by) in bends_by {
            let known = jacobian[(row, column)];
            jacobian[(row, column)] = known + by * moved;
        }
    }

    /// Applies the reading hysteresis to residual and Jacobian, if the sensor has one.
    fn hold(&self, segment: &Segment, residual: &mut DVector<f64>, jacobian: &mut DMatrix<f64>) {
        let Some(width) = self.measurement.reading else { return };
        let (rate, curvature) = (self.response.velocity[0], self.response.acceleration[0]);
        let values = segment.values.iter().zip(residual.iter()).map(|(observed, left)| observed - left);
        let readings = readings(values, width, rate, curvature);
        for (slot, (reading, observed)) in residual.iter_mut().zip(readings.iter().zip(&segment.values)) {
            *slot = observed - reading.value;
        }
        for mut column in jacobian.column_iter_mut() {
            for (row, reading) in readings.iter().enumerate() {
                column[row] = column[reading.since];
            }
        }
        if let Some(own) = self.by_width().filter(|_| self.derivatives == Derivatives::All) {
            let column = self.hypothesis.start_length() + own;
            for (row, reading) in readings.iter().enumerate() {
                jacobian[(row, column)] = reading.by_width;
            }
        }
    }

    /// Returns the index of the reading hysteresis among the global parameters.
    fn by_width(&self) -> Option<usize> {
        let index = self.hypothesis.effects().position(|effect| effect.holds_readings())?;
        self.sources.iter().position(|source| matches!(source, Source::Effect(at, _) if *at == index))
    }

    /// Converts derivatives by the laws' parameters into those by the fit parameters.
    fn combine(&self, jacobian: &mut DMatrix<f64>, starts: usize) {
        if self.derivatives != Derivatives::All {
            return;
        }
        for (effect, place, part) in self.hypothesis.all_parts(self.facts(), &self.point) {
            let slopes = effect.slopes(part);
            if let Some(at) = place.map(|place| starts + place).filter(|_| !slopes.is_empty()) {
                let law = jacobian.columns(at, part.len()).clone_owned();
                let mut change = DMatrix::identity(part.len(), part.len());
                for (row, column, slope) in slopes {
                    change[(row, column)] = slope;
                }
                jacobian.columns_mut(at, part.len()).copy_from(&(law * change));
            }
        }
    }

    /// Returns the start state of a segment that begins where this one ends: position, velocity, fitted
    /// hidden states.
    pub(crate) fn end(&mut self, segment: &Segment, start: &[f64]) -> Result<Vec<f64>, DynamicsError> {
        self.run(segment, start)?;
        let end = self.response.end;
        let own = end.hidden.iter().flat_map(|all| hidden(self.hypothesis).map(|index| all[index]));
        Ok([end.position, end.velocity].into_iter().chain(own).collect())
    }

    /// Returns the motion along a segment from a start state. Only for a simulator without derivatives.
    pub(crate) fn motion(&mut self, segment: &Segment, start: &[f64]) -> Result<Motion, DynamicsError> {
        self.run(segment, start)?;
        Ok(Motion {
            position: self.response.position.clone(),
            velocity: self.response.velocity.clone(),
            acceleration: self.response.acceleration.clone(),
        })
    }
}

impl Scales {
    /// Returns the equilibrium at a point: the rest angle, shifted by a known weight.
    pub(crate) fn rest(&self, point: &[f64], hypothesis: &Hypothesis) -> f64 {
        let at = hypothesis.calibrated.iter().position(|own| *own == Calibrated::RestAngle);
        let angle =
            at.and_then(|at| point.get(at)).copied().unwrap_or_else(|| hypothesis.nominal.rest_angle());
        angle + self.rest_moved
    }
}

/// Returns the effects in a hypothesis's system, with their indices among all and those of their first hidden
/// states.
fn system_effects(hypothesis: &Hypothesis) -> impl Iterator<Item = (usize, Candidate, usize)> {
    let mut hidden = 0;
    hypothesis.effects().enumerate().filter_map(move |(number, candidate)| {
        let effect = candidate.system()?;
        let from = hidden;
        hidden += effect.description().hidden_states;
        Some((number, candidate, from))
    })
}

/// Returns the contact that bends among a hypothesis's effects.
fn contact(hypothesis: &Hypothesis) -> Option<Contact> {
    system_effects(hypothesis).find_map(|(effect, candidate, hidden)| {
        let displacement = candidate.bending_displacement()?;
        Some(Contact { effect, displacement, hidden, column: None })
    })
}

/// Returns the indices, among the system's hidden states, of those that each segment fits.
fn hidden(hypothesis: &Hypothesis) -> impl Iterator<Item = usize> {
    system_effects(hypothesis).flat_map(|(_, effect, from)| from..from + effect.free_hidden().len())
}

#[cfg(test)]
#[path = "predictor_tests.rs"]
mod tests;
