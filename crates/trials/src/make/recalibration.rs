//! Part of an effect that no recalibration absorbs.
//!
//! The size of an effect in noise units is d = ‖P·Δ‖/σ. Δ is the effect's contribution to the samples; P
//! removes what damping, stiffness, rest angle, the initial state of each record and, if there is an input,
//! inertia can absorb. It is computed directly: the nominal oscillator, starting from its true coefficients,
//! is fitted to the noise-free samples with the effect (Gauss–Newton with exact sensitivities), and the root
//! of the residual's sum of squares is divided by σ.

#![allow(clippy::indexing_slicing, reason = "a step has an entry for every fitted quantity")]

use super::error::TrialError;
use super::situation::Situation;
use dynamics::chain::Samples;
use dynamics::sensitivity::{Free, FullState, Model, Response, Settings};
use dynamics::{Active, Effect, Hold, Input, System, SystemEffect};
use nalgebra::{DMatrix, DVector};

/// Quantities that a fit may adjust besides damping, stiffness and initial states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Absorbed {
    /// `true` if the rest angle may move; `false` if the hidden effect is a preload, which acts as a rest
    /// angle that the simulator lacks.
    pub(crate) rest_angle: bool,
    /// Effects of the system with one parameter, at any size of either sign, that could act as surrogate
    /// effects for a law outside the vocabulary.
    pub(crate) stand_ins: &'static [SystemEffect],
    /// `true` if a linear drift of the sensor is fitted.
    pub(crate) sensor_drift: bool,
}

impl Absorbed {
    /// Quantities that a recalibration adjusts.
    pub(crate) const BY_RECALIBRATION: Self = Self { rest_angle: true, stand_ins: &[], sensor_drift: false };
}

/// Largest number of rounds of the fit. Starting from the truth, the problem is nearly linear, and two rounds
/// are usually enough.
const ROUNDS: usize = 10;

/// Relative accuracy with which a round must predict the next residual's norm for the fit to end.
const SETTLED: f64 = 1e-3;

/// Norm, in units of the sensor's noise, that counts as zero. A fit that reaches it can stop; rounding errors
/// may keep it from going further.
const NOTHING: f64 = 1e-3;

/// Phase change in rad at the end of the record up to which a first step is trusted. Beyond it, the fit
/// proceeds over increasing parts of the record, so that it does not end in a minimum with the wrong number
/// of turns.
const TRUSTED_PHASE: f64 = 0.5;

/// Index of the stiffness among the unknowns.
const STIFFNESS: usize = 1;

/// Increasing parts of the record for such a fit.
const PARTS: [f64; 5] = [0.0625, 0.125, 0.25, 0.5, 1.0];

/// Returns the root of the sum of squares that the best recalibrated oscillator leaves of noise-free records,
/// in rad.
pub(crate) fn left_over(
    situation: &Situation,
    seen: &[Samples<f64>],
    absorbed: Absorbed,
) -> Result<f64, TrialError> {
    Recalibration::new(situation, seen, absorbed)?.run()
}

/// One round of the fit.
struct Round {
    /// Root of the residual's sum of squares at the current unknowns.
    norm: f64,
    /// Predicted norm after the step, assuming that the record is linear in the unknowns.
    expected: f64,
    step: DVector<f64>,
}

struct Recalibration<'a> {
    situation: &'a Situation,
    seen: &'a [Samples<f64>],
    model: Model,
    /// Model coefficients shared by the records; then the sensor's drift, if it is fitted; then position and
    /// velocity at the start of each record.
    unknowns: Vec<f64>,
    coefficients: usize,
    drift: bool,
    /// Index of the inertia among the unknowns; `None` if it is not fitted.
    inertia: Option<usize>,
}

impl<'a> Recalibration<'a> {
    fn new(
        situation: &'a Situation,
        seen: &'a [Samples<f64>],
        absorbed: Absorbed,
    ) -> Result<Self, TrialError> {
        let is = situation.nominal.coefficients();
        let mut free = vec![(Free::Damping, is.damping), (Free::Stiffness, is.stiffness)];
        if absorbed.rest_angle {
            free.push((Free::RestAngle, is.rest_angle));
        }
        if situation.excitation.is_some() {
            free.push((Free::Inertia, is.inertia));
        }
        let inertia = free.iter().position(|(name, _)| *name == Free::Inertia);
        let mut effects = Vec::new();
        for effect in absorbed.stand_ins.iter().copied().map(Effect::System) {
            if let [parameter] = effect.description().parameters {
                effects.push(Active::of(effect, &[0.0])?);
                free.push((Free::Effect { id: effect.id(), parameter: parameter.name }, 0.0));
            }
        }
        let (coefficients, drift) = (free.len(), absorbed.sensor_drift);
        let mut unknowns: Vec<f64> = free.iter().map(|(_, value)| *value).collect();
        unknowns.extend(drift.then_some(0.0));
        unknowns.extend(situation.starts.iter().flat_map(|start| [start.position, start.velocity]));
        let mut names: Vec<Free> = free.into_iter().map(|(name, _)| name).collect();
        names.extend([Free::StartPosition, Free::StartVelocity]);
        let system = System::new(situation.nominal, effects)?;
        let model = Model::new(&system, &names, Settings::default())?;
        Ok(Self { situation, seen, model, unknowns, coefficients, drift, inertia })
    }

    fn run(mut self) -> Result<f64, TrialError> {
        let first = self.round(1.0)?;
        let parts = if self.phase_moved(&first) > TRUSTED_PHASE { &PARTS[..] } else { &[1.0][..] };
        let mut left = f64::INFINITY;
        for &part in parts {
            left = self.fit(part)?;
        }
        Ok(left)
    }

    /// Returns the phase change at the end of a record that a step causes through stiffness and inertia.
    fn phase_moved(&self, round: &Round) -> f64 {
        let nominal = &self.situation.nominal;
        let stiffness = round.step[STIFFNESS] / nominal.stiffness();
        let relative =
            self.inertia.map_or(stiffness, |place| stiffness - round.step[place] / nominal.inertia());
        0.5 * relative.abs() * self.situation.omega() * self.situation.duration()
    }

    /// Returns the norm that the best unknowns leave over a part of each record; infinite if the fit does not
    /// converge.
    fn fit(&mut self, part: f64) -> Result<f64, TrialError> {
        let mut round = self.round(part)?;
        for _ in 0..ROUNDS {
            if round.norm <= NOTHING * self.situation.noise {
                return Ok(round.norm);
            }
            let from = self.unknowns.clone();
            let mut share = 1.0;
            let next = loop {
                for ((unknown, from), step) in self.unknowns.iter_mut().zip(&from).zip(round.step.iter()) {
                    *unknown = from + share * step;
                }
                match self.round(part) {
                    Ok(next) if next.norm <= round.norm => break Some(next),
                    _ if share < 0.01 => break None,
                    // The norm grew or the motion diverged: the step was too long.
                    _ => share *= 0.25,
                }
            };
            let Some(next) = next else {
                self.unknowns = from;
                let is_least = round.expected >= (1.0 - SETTLED) * round.norm;
                return Ok(if is_least { round.expected } else { f64::INFINITY });
            };
            if share == 1.0 && (next.norm - round.expected).abs() <= SETTLED * next.norm {
                return Ok(next.expected);
            }
            round = next;
        }
        Ok(f64::INFINITY)
    }

    /// Returns residual norm and step at the current unknowns, over a part of each record from its beginning.
    fn round(&mut self, part: f64) -> Result<Round, TrialError> {
        let count = self.unknowns.len();
        let mut normal = DMatrix::<f64>::zeros(count, count);
        let mut gradient = DVector::<f64>::zeros(count);
        let unknowns = self.unknowns.clone();
        let (coefficients, rest) = unknowns.split_at(self.coefficients);
        let (drift, starts) = rest.split_at(usize::from(self.drift));
        let slope = drift.first().copied().unwrap_or_default();
        self.model.set(coefficients)?;
        let mut row: Vec<(usize, f64)> = Vec::with_capacity(count);
        let mut squares = 0.0;
        let mut samples = 0;
        let mut response = Response::default();
        for (record, (seen, start)) in self.seen.iter().zip(starts.chunks_exact(2)).enumerate() {
            let &[position, velocity] = start else { continue };
            // The first sample's timestamp may be later than its time; the motion starts at the sample's
            // time.
            let start_time = seen.times_s.iter().take(1).fold(0.0, |start: f64, time| start.min(*time));
            let used = (part * seen.values.len() as f64).ceil() as usize;
            let stamps = seen.stamps_s.iter().take(used).copied();
            let times: Vec<f64> = std::iter::once(start_time).chain(stamps).collect();
            let state = FullState { position, velocity, hidden: None };
            let input = self.input(seen)?;
            self.model.run_into(state, input.as_ref(), &times, &mut response)?;
            let before = drift.len() + 2 * record;
            let place = |own: usize| if own < self.coefficients { own } else { own + before };
            let predictions = response.position.iter().skip(1);
            let samples_seen = seen.values.iter().zip(&seen.stamps_s).zip(predictions);
            for (index, ((value, stamp), predicted)) in samples_seen.enumerate().take(used) {
                let residual = value - predicted - slope * stamp;
                squares += residual * residual;
                row.clear();
                let own = response.position_row(index + 1).iter().enumerate();
                row.extend(own.map(|(own, sensitivity)| (place(own), *sensitivity)));
                row.extend(self.drift.then_some((self.coefficients, *stamp)));
                for &(column, sensitivity) in &row {
                    if let Some(slot) = gradient.get_mut(column) {
                        *slot += sensitivity * residual;
                    }
                    for &(other, second) in row.iter().filter(|(other, _)| *other <= column) {
                        if let Some(slot) = normal.get_mut((column, other)) {
                            *slot += sensitivity * second;
                        }
                    }
                }
            }
            samples += used;
        }
        let singular = TrialError::Singular { samples, unknowns: count };
        let step = solve(normal, gradient.clone()).ok_or(singular)?;
        let expected = (squares - gradient.dot(&step)).max(0.0).sqrt();
        Ok(Round { norm: squares.sqrt(), expected, step })
    }

    /// Returns the input as the file states it: its samples have the timestamps of the values beside them.
    fn input(&self, seen: &Samples<f64>) -> Result<Option<Input>, TrialError> {
        let Some(excitation) = self.situation.excitation else { return Ok(None) };
        let duration = self.situation.duration();
        let values = seen.times_s.iter().map(|&time| excitation.at(time, duration)).collect();
        Ok(Some(Input::new(seen.stamps_s.clone(), values, Hold::Zero)?))
    }
}

/// Ridge added to the unit diagonal: a short part of a record may leave a combination of unknowns
/// undetermined, which then keeps its value.
const RIDGE: f64 = 1e-11;

/// Solves normal equations given by their lower triangle, with each unknown scaled to a unit diagonal.
fn solve(mut normal: DMatrix<f64>, mut gradient: DVector<f64>) -> Option<DVector<f64>> {
    let scale = normal.diagonal().map(|square| if square > 0.0 { square.sqrt().recip() } else { 0.0 });
    for (index, entry) in normal.iter_mut().enumerate() {
        let (row, column) = (index % scale.len(), index / scale.len());
        *entry *= scale.get(row)? * scale.get(column)?;
    }
    for at in 0..scale.len() {
        *normal.get_mut((at, at))? += RIDGE;
    }
    gradient.component_mul_assign(&scale);
    let solution = normal.cholesky()?.solve(&gradient);
    Some(solution.component_mul(&scale))
}
