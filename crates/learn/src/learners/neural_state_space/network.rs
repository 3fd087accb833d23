//! Discrete state space with small networks: x⁺ = x + step·f(x, u), y = x₁.
#![allow(clippy::indexing_slicing, reason = "rows and columns follow from the shape")]

use rand_distr::{Distribution, StandardNormal};
use seed::Seed;
use serde::{Deserialize, Serialize};

/// Features that a state's rate depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Wiring {
    /// State and next state; the input acts on the last state.
    Chain,
    /// All states and the input.
    Full,
}

/// Dimensions of a network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Shape {
    pub(super) wiring: Wiring,
    /// Number of states; the first is the observed quantity.
    pub(super) states: usize,
    /// Number of inputs of a step.
    pub(super) inputs: usize,
    /// Number of tanh units of each state.
    pub(super) units: usize,
    /// Step in radians of the typical period.
    pub(super) step: f64,
}

/// Free run with its sensitivities.
pub(super) struct Run {
    /// States at every sample, row-major; from a divergence on, not a number.
    pub(super) states: Vec<f64>,
    /// Derivatives of the observed quantity with respect to weights and start state, row-major; empty unless asked for.
    pub(super) slopes: Vec<f64>,
}

/// Absolute scaled state beyond which a run counts as diverged.
const BOUND: f64 = 50.0;

impl Shape {
    /// Returns the features of a state's rate: states come first, then inputs.
    fn features(&self, state: usize) -> Vec<usize> {
        let all = self.states + self.inputs;
        match self.wiring {
            Wiring::Full => (0..all).collect(),
            Wiring::Chain if state + 1 == self.states => (state..all).collect(),
            Wiring::Chain => vec![state, state + 1],
        }
    }

    /// Returns the number of weights of a state: constant and linear weights, then bias, weights and output of each
    /// unit.
    fn of_state(&self, state: usize) -> usize {
        let features = self.features(state).len();
        1 + features + self.units * (features + 2)
    }

    /// Returns the number of weights.
    pub(super) fn weights(&self) -> usize {
        (0..self.states).map(|state| self.of_state(state)).sum()
    }

    /// Draws a linear system of the typical period, or a cascade, with units that have no effect yet.
    pub(super) fn drawn(&self, seed: &Seed) -> Vec<f64> {
        let mut generator = seed.generator();
        let mut normal = || -> f64 { StandardNormal.sample(&mut generator) };
        let mut weights = Vec::new();
        for state in 0..self.states {
            let features = self.features(state);
            weights.push(0.0);
            weights.extend(features.iter().map(|&feature| self.first(state, feature)));
            for _ in 0..self.units {
                weights.extend((0..=features.len()).map(|_| normal()));
                weights.push(0.0);
            }
        }
        weights
    }

    /// Returns the first guess of a linear weight.
    fn first(&self, state: usize, feature: usize) -> f64 {
        let input = |share: f64| if feature >= self.states { share / self.inputs as f64 } else { 0.0 };
        match self.wiring {
            Wiring::Chain if feature == state => -1.0,
            Wiring::Chain if feature < self.states => 1.0,
            Wiring::Chain => input(1.0),
            // An oscillator: position and velocity; hidden states follow the velocity.
            Wiring::Full => match (state, feature) {
                (0, 1) => 1.0,
                (1, 0) => -1.0,
                (1, 1) => -self.step,
                (0, _) => 0.0,
                (1, _) if feature < self.states => 0.1,
                (1, _) => input(1.0),
                (_, 1) => 1.0,
                (own, _) if own == feature => -1.0,
                _ => 0.0,
            },
        }
    }

    /// Runs freely from a start state over the inputs, of which each sample has `self.inputs`.
    pub(super) fn run(
        &self,
        weights: &[f64],
        start: &[f64],
        inputs: &[f64],
        samples: usize,
        sloped: bool,
    ) -> Run {
        let (count, columns) = (self.states, weights.len() + self.states);
        let features: Vec<Vec<usize>> = (0..count).map(|state| self.features(state)).collect();
        let mut found = Run { states: start.to_vec(), slopes: Vec::new() };
        found.states.reserve(samples * count);
        let mut slope = vec![0.0; if sloped { count * columns } else { 0 }];
        if sloped {
            (0..count).for_each(|state| slope[state * columns + weights.len() + state] = 1.0);
        }
        let mut place = start.to_vec();
        place.resize(count + self.inputs, 0.0);
        let (mut next, mut next_slope) = (vec![0.0; count], slope.clone());
        for sample in 0..samples {
            if sloped {
                found.slopes.extend_from_slice(&slope[..columns]);
            }
            if sample + 1 == samples {
                break;
            }
            place[count..].copy_from_slice(&inputs[sample * self.inputs..][..self.inputs]);
            let mut from = 0;
            for (state, own) in features.iter().enumerate() {
                let to = from + self.of_state(state);
                let row = if sloped { Some(&mut next_slope[state * columns..][..columns]) } else { None };
                next[state] = self.advanced((state, own), &weights[from..to], &place, (&slope, row, from));
                from = to;
            }
            if !next.iter().all(|value| value.abs() < BOUND) {
                found.states.resize(samples * count, f64::NAN);
                found.slopes.resize(if sloped { samples * columns } else { 0 }, 0.0);
                break;
            }
            place[..count].copy_from_slice(&next);
            found.states.extend_from_slice(&next);
            std::mem::swap(&mut slope, &mut next_slope);
        }
        found
    }

    /// Returns a state after a step. Writes its derivatives into `row`, where one is given; the state's weights begin
    /// at the column `from`.
    fn advanced(
        &self,
        (state, features): (usize, &[usize]),
        weights: &[f64],
        place: &[f64],
        (slope, row, from): (&[f64], Option<&mut [f64]>, usize),
    ) -> f64 {
        let (linear, units) = weights.split_at(1 + features.len());
        let read = |weights: &[f64]| -> f64 {
            weights[0]
                + features.iter().zip(&weights[1..]).map(|(&at, weight)| weight * place[at]).sum::<f64>()
        };
        let of_unit = features.len() + 2;
        let active: Vec<f64> = units.chunks_exact(of_unit).map(|unit| read(unit).tanh()).collect();
        let outputs = units.chunks_exact(of_unit).map(|unit| unit[of_unit - 1]);
        let rate = read(linear) + outputs.zip(&active).map(|(output, active)| output * active).sum::<f64>();
        if let Some(row) = row {
            let columns = row.len();
            row.copy_from_slice(&slope[state * columns..][..columns]);
            for (number, &feature) in
                features.iter().enumerate().filter(|(_, feature)| **feature < self.states)
            {
                let steep = |(unit, active): (&[f64], &f64)| {
                    unit[of_unit - 1] * (1.0 - active * active) * unit[1 + number]
                };
                let by =
                    linear[1 + number] + units.chunks_exact(of_unit).zip(&active).map(steep).sum::<f64>();
                let other = &slope[feature * columns..][..columns];
                row.iter_mut().zip(other).for_each(|(sum, own)| *sum += self.step * by * own);
            }
            let own = &mut row[from..from + weights.len()];
            let (own_linear, own_units) = own.split_at_mut(1 + features.len());
            let spread = |into: &mut [f64], factor: f64| {
                into[0] += factor;
                features.iter().zip(&mut into[1..]).for_each(|(&at, sum)| *sum += factor * place[at]);
            };
            spread(own_linear, self.step);
            let pairs = own_units.chunks_exact_mut(of_unit).zip(units.chunks_exact(of_unit));
            for ((into, unit), active) in pairs.zip(&active) {
                spread(&mut into[..=features.len()], self.step * unit[of_unit - 1] * (1.0 - active * active));
                into[of_unit - 1] += self.step * active;
            }
        }
        place[state] + self.step * rate
    }
}
