//! Samples and energy accounts along the steps.

#![allow(clippy::indexing_slicing, reason = "the analysis has a weight for every stage")]

use super::gauss::{Gauss, MOST_STAGES, basis};
use super::motion::{Account, Motion, Worker};
use super::step::{Step, state};
use crate::field::{Field, MOST_EFFECTS, Mode};
use crate::system::Drive;

/// Maximum number of accounts: damping, input, effects.
const MOST_ACCOUNTS: usize = MOST_EFFECTS + 2;

/// Recorder that fills a motion while steps are made.
#[derive(Debug)]
pub(crate) struct Recorder {
    pub(crate) motion: Motion,
    /// Index of the next requested time.
    next: usize,
    /// Work at the start of the present step.
    work: [f64; MOST_ACCOUNTS],
    /// Legendre series of the powers of the present step.
    series: [[f64; MOST_ACCOUNTS]; MOST_STAGES],
}

impl Recorder {
    pub(crate) fn new(field: &Field<f64>, samples: usize) -> Self {
        let workers = [Worker::Damping, Worker::Input].into_iter();
        let effects = field.terms.iter().map(|term| Worker::Effect(term.effect.description().id));
        let accounts = workers
            .chain(effects)
            .map(|worker| Account { worker, work: Vec::with_capacity(samples) })
            .collect();
        let motion = Motion {
            position: Vec::with_capacity(samples),
            velocity: Vec::with_capacity(samples),
            acceleration: Vec::with_capacity(samples),
            accounts,
            ..Motion::default()
        };
        Self { motion, next: 0, work: [0.0; MOST_ACCOUNTS], series: [[0.0; MOST_ACCOUNTS]; MOST_STAGES] }
    }

    /// Returns `true` if every requested time is recorded.
    pub(crate) fn complete(&self, times: &[f64]) -> bool {
        self.next >= times.len()
    }

    /// Records the times up to the end of an accepted step.
    pub(crate) fn step(
        &mut self,
        gauss: &Gauss,
        field: &Field<f64>,
        mode: &Mode,
        drive: &Drive<'_>,
        step: &Step,
        times: &[f64],
    ) {
        self.powers(gauss, field, mode, drive, step);
        let end = step.from + step.size;
        while let Some(&time) = times.get(self.next).filter(|&&time| time <= end) {
            let tau = if step.size > 0.0 { ((time - step.from) / step.size).clamp(0.0, 1.0) } else { 0.0 };
            let basis = basis(tau, gauss.stages());
            let vector = step.with_basis(&basis);
            let state = state(time, &vector, drive.torque(time));
            let (acceleration, _) = field.rates(&state, mode);
            self.motion.position.push(state.position);
            self.motion.velocity.push(state.velocity);
            self.motion.acceleration.push(acceleration);
            for (number, (account, done)) in self.motion.accounts.iter_mut().zip(&self.work).enumerate() {
                account.work.push(done + work(&self.series, &basis, number) * step.size);
            }
            self.next += 1;
        }
        let basis = basis(1.0, gauss.stages());
        for (number, total) in self.work.iter_mut().enumerate() {
            *total += work(&self.series, &basis, number) * step.size;
        }
    }

    fn powers(&mut self, gauss: &Gauss, field: &Field<f64>, mode: &Mode, drive: &Drive<'_>, step: &Step) {
        for coefficients in &mut self.series {
            coefficients.fill(0.0);
        }
        if mode.sticks() {
            return;
        }
        for (stage, (node, vector)) in gauss.nodes.iter().zip(&step.stages).enumerate() {
            let time = step.from + node * step.size;
            let state = state(time, vector, drive.torque(time));
            let [input, _] = state.input;
            let nominal = [field.damping(&state), input].into_iter();
            let effects =
                field.moments(&state, mode).map(|(term, moment)| term.effect.torque(&term.values, &moment));
            let mut powers = [0.0; MOST_ACCOUNTS];
            for (power, torque) in powers.iter_mut().zip(nominal.chain(effects)) {
                *power = torque * state.velocity;
            }
            for (row, coefficients) in gauss.analysis.iter().zip(&mut self.series) {
                for (coefficient, power) in
                    coefficients.iter_mut().zip(powers).take(self.motion.accounts.len())
                {
                    *coefficient += row[stage] * power;
                }
            }
        }
    }
}

fn work(series: &[[f64; MOST_ACCOUNTS]; MOST_STAGES], basis: &[f64; MOST_STAGES], number: usize) -> f64 {
    let coefficients = series.iter().filter_map(|coefficients| coefficients.get(number));
    coefficients.zip(basis).map(|(coefficient, basis)| coefficient * basis).sum()
}
