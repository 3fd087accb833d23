//! Simulators as models: nominal, recalibrated, repaired by a diagnosis, and the true law with fitted
//! coefficients.

use crate::data::{DataSet, Trajectory};
use crate::flow::{Fit, LENGTHS, Shooter, Shooting, Shot, State, first_guess, fit, phase_name};
use crate::judge::validation_error;
use crate::{Ahead, Coefficient, Context, Fitted, LearnError, Model, Past, Place, Predicted, Torque};
use diagnosis::{Observations, diagnose};
use dynamics::sensitivity::{Free, FullState, Model as Motion, Settings};
use dynamics::{Active, Effect, Hold, Input, NominalSimulator, System};
use estimator::Reached;
use nalgebra::{Matrix2, Vector2};
use record::{Clock, ClockChoice, Quantity, Record};

/// Simulator as a model.
#[derive(Debug, Clone)]
pub struct Simulated {
    system: System,
    hold: Hold,
    period_s: f64,
    fitted: usize,
    coefficients: Vec<Coefficient>,
}

/// Gauss–Newton steps of a search for an initial state.
const STEPS: usize = 8;

/// Builds the system of a nominal simulator: its oscillator with the simulator's known effects on the motion.
/// Effects of the measurement chain are left out.
///
/// # Errors
/// [`LearnError::Dynamics`] if the effects contradict each other.
pub fn system_of(nominal: &NominalSimulator) -> Result<System, LearnError> {
    let acting = nominal.effects().iter().map(|known| known.active);
    let acting: Vec<Active> = acting.filter(|active| matches!(active.effect(), Effect::System(_))).collect();
    Ok(System::new(*nominal.nominal(), acting)?)
}

fn input_of(times_s: &[f64], values: Option<&[f64]>, hold: Hold) -> Result<Option<Input>, LearnError> {
    Ok(values.map(|values| Input::new(times_s.to_vec(), values.to_vec(), hold)).transpose()?)
}

impl Simulated {
    fn new(system: System, data: &DataSet, fitted: usize) -> Self {
        Self { system, hold: data.hold, period_s: data.period_s, fitted, coefficients: Vec::new() }
    }

    /// Fits the state at the past's first sample by least squares: Gauss–Newton with exact sensitivities.
    fn start(&self, past: &Trajectory) -> Result<State, LearnError> {
        let free = [Free::StartPosition, Free::StartVelocity];
        let mut model = Motion::new(&self.system, &free, Settings::default())?;
        let input = input_of(past.times_s(), past.input(), self.hold)?;
        let mut run = |state: State| model.run(full(state), input.as_ref(), past.times_s());
        let rss = |positions: &[f64]| -> f64 {
            past.values().iter().zip(positions).map(|(a, b)| (a - b).powi(2)).sum()
        };
        let mut state = first_guess(past, self.period_s);
        let mut response = run(state)?;
        for _ in 0..STEPS {
            let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
            let rows = response.position_sensitivity.as_chunks::<2>().0.iter();
            for ((observed, predicted), row) in past.values().iter().zip(&response.position).zip(rows) {
                let row = Vector2::from(*row);
                normal += row * row.transpose();
                right += row * (observed - predicted);
            }
            let Some(step) = normal.try_inverse().map(|inverse| inverse * right) else { break };
            let before = rss(&response.position);
            let next = State { position: state.position + step.x, velocity: state.velocity + step.y };
            match run(next).ok().filter(|found| rss(&found.position) < before * (1.0 - 1e-7)) {
                Some(found) => (state, response) = (next, found),
                None => break,
            }
        }
        Ok(state)
    }
}

fn full(state: State) -> FullState {
    FullState { position: state.position, velocity: state.velocity, hidden: None }
}

impl Model for Simulated {
    fn free_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        let own = |column: Option<&[f64]>| column.map(<[f64]>::to_vec);
        let part = Trajectory::new("past", past.times_s.to_vec(), past.values.to_vec(), own(past.input))?;
        let state = self.start(&part)?;
        let times = [past.times_s, ahead.times_s].concat();
        let values = past.input.zip(ahead.input).map(|(before, after)| [before, after].concat());
        let input = input_of(&times, values.as_deref(), self.hold)?;
        let mut model = Motion::new(&self.system, &[], Settings::default())?;
        let mut response = model.run(full(state), input.as_ref(), &times)?;
        Ok(Predicted { values: response.position.split_off(past.times_s.len()), std: None })
    }

    fn parameters(&self) -> usize {
        self.fitted
    }

    fn coefficients(&self) -> &[Coefficient] {
        &self.coefficients
    }

    fn torque(&self, place: &Place) -> Option<Torque> {
        if self.system.hidden_states() > 0 {
            return None;
        }
        let settings = Settings { velocity: true, acceleration: true, ..Settings::default() };
        let mut model = Motion::new(&self.system, &[], settings).ok()?;
        let start = FullState { position: place.position, velocity: place.velocity, hidden: None };
        let input = Input::new(vec![0.0], vec![place.input], Hold::Zero).ok()?;
        let value = *model.run(start, Some(&input), &[0.0]).ok()?.acceleration.first()?;
        Some(Torque { value, std: None })
    }
}

fn nominal_of<'a>(data: &'a DataSet, what: &'static str) -> Result<&'a NominalSimulator, LearnError> {
    data.nominal.as_ref().ok_or(LearnError::NoNominal { what })
}

fn fitted(model: Simulated, steps: u64, converged: bool) -> Fitted {
    let reached = if converged { Reached::Converged } else { Reached::BudgetSpent };
    Fitted { model: Box::new(model), reached, steps }
}

/// Builds the nominal simulator without fitting anything.
///
/// # Errors
/// [`LearnError::NoNominal`], [`LearnError::Dynamics`].
pub fn nominal(data: &DataSet, _context: &Context<'_>) -> Result<Fitted, LearnError> {
    let system = system_of(nominal_of(data, "the baseline `nominal`")?)?;
    Ok(fitted(Simulated::new(system, data, 0), 0, true))
}

/// Builds the recalibrated simulator: the nominal one with its own coefficients fitted. Its effects stay as
/// stated.
///
/// # Errors
/// As [`nominal`].
pub fn recalibrated(data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError> {
    let nominal = nominal_of(data, "the baseline `recalibrated`")?;
    let mut free = vec![Free::Damping, Free::Stiffness];
    if nominal.nominal().stiffness() > 0.0 {
        free.push(Free::RestAngle);
    }
    if data.is_driven() {
        free.push(Free::InputGain);
    }
    calibrated(system_of(nominal)?, &free, data, context)
}

/// Fits the coefficients of the true law to whole trajectories: the best that a learner could reach.
///
/// # Errors
/// As [`recalibrated`].
pub fn exact(truth: &System, data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError> {
    let nominal = truth.nominal();
    let mut free = vec![Free::Damping, Free::Stiffness];
    if nominal.stiffness() > 0.0 && nominal.rest_angle() != 0.0 {
        free.push(Free::RestAngle);
    }
    if data.is_driven() {
        free.push(Free::InputGain);
    }
    for active in truth.effects() {
        let parameters = active.effect().description().parameters.iter().zip(active.values());
        free.extend(
            parameters
                .filter(|(_, value)| **value != 0.0)
                .map(|(parameter, _)| Free::Effect { id: active.id(), parameter: parameter.name }),
        );
    }
    calibrated(truth.clone(), &free, data, context)
}

/// System that predicts pieces, with some of its coefficients free.
struct SystemShooter {
    model: Motion,
    hold: Hold,
    weights: usize,
}

impl Shooter for SystemShooter {
    fn weights(&self) -> usize {
        self.weights
    }

    fn shoot(&self, weights: &[f64], start: State, piece: &Trajectory) -> Result<Shot, LearnError> {
        let mut model = self.model.clone();
        model.set(weights)?;
        let input = input_of(piece.times_s(), piece.input(), self.hold)?;
        let response = model.run(full(start), input.as_ref(), piece.times_s())?;
        let pairs = piece.values().iter().zip(&response.position);
        Ok(Shot {
            residuals: pairs.map(|(observed, predicted)| observed - predicted).collect(),
            jacobian: response.position_sensitivity,
        })
    }
}

/// Largest number of training samples used by a calibration.
const SAMPLES: usize = 20_000;

fn calibrated(
    system: System,
    free: &[Free],
    data: &DataSet,
    context: &Context<'_>,
) -> Result<Fitted, LearnError> {
    let columns = [free, &[Free::StartPosition, Free::StartVelocity]].concat();
    let shooter = SystemShooter {
        model: Motion::new(&system, &columns, Settings::default())?,
        hold: data.hold,
        weights: free.len(),
    };
    let start = free.iter().map(|quantity| {
        value(&system, *quantity).ok_or_else(|| LearnError::Unsolvable {
            what: "recalibration",
            problem: format!("the simulator has no {}", name(*quantity)),
        })
    });
    let mut weights = start.collect::<Result<Vec<f64>, _>>()?;
    let mut best: Option<(f64, Simulated, Fit)> = None;
    for periods in LENGTHS {
        let pieces = data.training_pieces(periods * data.period_s, SAMPLES);
        let starts = pieces.iter().map(|piece| first_guess(piece, data.period_s)).collect();
        let phase = phase_name(periods);
        let shooting =
            Shooting { pieces: &pieces, noise: data.noise, penalty: None, most_steps: 40, phase: &phase };
        let found = match fit(&shooter, &shooting, weights.clone(), starts, context) {
            Ok(found) => found,
            Err(LearnError::Interrupted) => return Err(LearnError::Interrupted),
            Err(_) => break,
        };
        weights = found.weights.clone();
        let Some(own) = with_values(&system, free, &weights) else { break };
        let mut model = Simulated::new(own, data, free.len());
        model.coefficients = coefficients(free, &found);
        let error = validation_error(&model, data);
        if best.as_ref().is_none_or(|(least, ..)| error <= 1.02 * least) {
            best = Some((error, model, found));
        }
    }
    let (_, model, found) = best.ok_or(LearnError::Unsolvable {
        what: "recalibration",
        problem:
            "the nominal simulator cannot follow two periods of the records; check its numbers and units"
                .to_owned(),
    })?;
    Ok(fitted(model, found.steps, found.converged))
}

fn name(quantity: Free) -> String {
    match quantity {
        Free::Inertia => "inertia".to_owned(),
        Free::Damping => "damping".to_owned(),
        Free::Stiffness => "stiffness".to_owned(),
        Free::RestAngle => "rest_angle".to_owned(),
        Free::InputGain => "input_gain".to_owned(),
        Free::Effect { id, parameter } => format!("{id}.{parameter}"),
        Free::StartPosition | Free::StartVelocity | Free::StartHidden(_) => "start".to_owned(),
    }
}

fn coefficients(free: &[Free], fit: &Fit) -> Vec<Coefficient> {
    let covariance = fit.covariance();
    let error =
        |place: usize| covariance.as_ref().and_then(|all| all.get((place, place))).map(|own| own.sqrt());
    let one = |(place, (quantity, value)): (usize, (&Free, &f64))| Coefficient {
        name: name(*quantity),
        value: *value,
        unit: "as in the nominal simulator".to_owned(),
        std_error: error(place),
        inclusion: None,
    };
    free.iter().zip(&fit.weights).enumerate().map(one).collect()
}

/// Returns the value of a quantity in a system; `None` for an effect that the system lacks, and for an
/// initial state, which is not part of the system.
fn value(system: &System, quantity: Free) -> Option<f64> {
    let nominal = system.nominal().coefficients();
    match quantity {
        Free::Inertia => Some(nominal.inertia),
        Free::Damping => Some(nominal.damping),
        Free::Stiffness => Some(nominal.stiffness),
        Free::RestAngle => Some(nominal.rest_angle),
        Free::InputGain => Some(nominal.input_gain),
        Free::Effect { id, parameter } => {
            system.effects().iter().find(|active| active.id() == id)?.value(parameter)
        }
        Free::StartPosition | Free::StartVelocity | Free::StartHidden(_) => None,
    }
}

/// Returns the system with fitted values; `None` if the values have no physical meaning.
fn with_values(system: &System, free: &[Free], values: &[f64]) -> Option<System> {
    let mut coefficients = system.nominal().coefficients();
    let mut effects: Vec<Active> = system.effects().to_vec();
    for (quantity, &value) in free.iter().zip(values) {
        match *quantity {
            Free::Inertia => coefficients.inertia = value,
            Free::Damping => coefficients.damping = value.max(0.0),
            Free::Stiffness => coefficients.stiffness = value.max(0.0),
            Free::RestAngle => coefficients.rest_angle = value,
            Free::InputGain => coefficients.input_gain = value,
            Free::Effect { id, parameter } => {
                let active = effects.iter_mut().find(|active| active.id() == id)?;
                let index = active.effect().description().parameter_index(parameter)?;
                let mut own = active.values().to_vec();
                *own.get_mut(index)? = value;
                *active = Active::of(active.effect(), &own).ok()?;
            }
            Free::StartPosition | Free::StartVelocity | Free::StartHidden(_) => {}
        }
    }
    System::new(system.nominal().with_coefficients(coefficients).ok()?, effects).ok()
}

/// Largest number of training samples passed to the diagnosis, which limits the time spent on one row of a
/// table.
const DIAGNOSED: usize = 20_000;

/// Builds the simulator that `diagnose` repairs from the training part.
///
/// # Errors
/// [`LearnError::NoNominal`], [`LearnError::Diagnosis`].
pub fn repaired(data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError> {
    let nominal = nominal_of(data, "the baseline `repaired`")?;
    let refused = |problem: String| LearnError::Diagnosis(problem);
    let (mut observations, mut samples) = (Vec::new(), 0);
    for part in &data.train {
        if samples > 0 && samples + part.len() > DIAGNOSED {
            break;
        }
        samples += part.len();
        let unit = if data.unit == "m" { "m" } else { "rad" };
        let input = part.input().map(<[f64]>::to_vec);
        let record =
            Record::new(part.times_s().to_vec(), part.values().to_vec(), input, Quantity::Position, unit);
        let record = record.map_err(|fault| refused(format!("{fault:?}")))?;
        let clock = Clock::new(&record, ClockChoice::Host).map_err(|fault| refused(format!("{fault:?}")))?;
        observations.push(Observations::new(&record, &clock));
    }
    let settings = diagnosis::Settings { seed: context.seed.clone(), ..diagnosis::Settings::default() };
    let found = diagnose(&observations, nominal, &settings, &|| 0.0);
    let found = found.map_err(|error| refused(error.to_string()))?;
    let acting = found.repaired.effects.iter().copied();
    let acting: Vec<Active> = acting.filter(|active| matches!(active.effect(), Effect::System(_))).collect();
    let fitted_numbers =
        found.calibration.len() + acting.iter().map(|active| active.values().len()).sum::<usize>();
    let system = System::new(found.repaired.nominal, acting)?;
    let hold = found.repaired.input_hold.unwrap_or(data.hold);
    Ok(fitted(Simulated { hold, ..Simulated::new(system, data, fitted_numbers) }, 1, true))
}
