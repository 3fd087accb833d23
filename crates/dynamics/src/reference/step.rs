//! One step of collocation on a smooth piece.

use super::gauss::{Gauss, MOST_STAGES, basis};
use crate::field::{Field, Mode, SYSTEM_HIDDEN, State};
use crate::system::Drive;

/// Length of a state vector: position, velocity, hidden state.
pub(crate) const LENGTH: usize = 2 + SYSTEM_HIDDEN;

/// Position, velocity and hidden state; unused entries are zero.
pub(crate) type Vector = [f64; LENGTH];

pub(crate) fn state(time: f64, vector: &Vector, input: [f64; 2]) -> State<f64> {
    let [position, velocity, hidden @ ..] = *vector;
    State { time, position, velocity, hidden, input }
}

/// Step with its collocation polynomial.
#[derive(Debug, Clone)]
pub(crate) struct Step {
    pub(crate) from: f64,
    pub(crate) size: f64,
    pub(crate) begin: Vector,
    /// States at the nodes.
    pub(crate) stages: Vec<Vector>,
    rates: Vec<Vector>,
    /// Coefficient k of the Legendre series of the rates.
    series: Vec<Vector>,
    /// Number of state variables in use.
    length: usize,
}

/// Outcome of solving a step.
pub(crate) enum Solved {
    /// The stages agree with the rates to rounding.
    Converged,
    /// The stages do not agree: the step is too large for fixed-point iteration.
    TooLarge,
}

impl Step {
    pub(crate) fn new(stages: usize, length: usize) -> Self {
        let zero = [0.0; LENGTH];
        Self {
            from: 0.0,
            size: 0.0,
            begin: zero,
            stages: vec![zero; stages],
            rates: vec![zero; stages],
            series: vec![zero; stages],
            length,
        }
    }

    /// Solves the stage equations from `begin` at time `from` by fixed-point iteration.
    pub(crate) fn solve(
        &mut self,
        gauss: &Gauss,
        field: &Field<f64>,
        mode: &Mode,
        drive: &Drive<'_>,
        scale: &Vector,
        iterations: usize,
    ) -> Solved {
        self.guess(field, mode, drive);
        let mut last = f64::INFINITY;
        for _ in 0..iterations {
            // Every stage uses the newest rates of the others: an integral equation in time is then solved
            // almost by marching, in half the iterations of a simultaneous update.
            let mut change = 0.0_f64;
            for (number, (row, node)) in gauss.matrix.iter().zip(&gauss.nodes).enumerate() {
                let mut sum = [0.0; LENGTH];
                for (weight, rate) in row.iter().zip(&self.rates) {
                    for (sum, rate) in sum.iter_mut().zip(rate).take(self.length) {
                        *sum += weight * rate;
                    }
                }
                let mut stage = self.begin;
                for (component, sum) in stage.iter_mut().zip(sum) {
                    *component += self.size * sum;
                }
                let new = rates(field, mode, drive, self.from + node * self.size, &stage);
                let Some(rate) = self.rates.get_mut(number) else { continue };
                for ((old, new), scale) in rate.iter_mut().zip(new).zip(scale).take(self.length) {
                    let moved = (*old - new).abs() * self.size / scale.max(f64::MIN_POSITIVE);
                    // `max` ignores NaN.
                    change = if moved.is_finite() { change.max(moved) } else { f64::INFINITY };
                    *old = new;
                }
                if let Some(slot) = self.stages.get_mut(number) {
                    *slot = stage;
                }
            }
            if !change.is_finite() {
                return Solved::TooLarge;
            }
            // Rounding ends the descent slightly above the last bit; more iterations then gain nothing.
            if change < 1e-15 || (change >= last && change < 1e-12) {
                self.analyze(gauss);
                return Solved::Converged;
            }
            if change > 4.0 * last {
                return Solved::TooLarge;
            }
            last = change;
        }
        Solved::TooLarge
    }

    fn guess(&mut self, field: &Field<f64>, mode: &Mode, drive: &Drive<'_>) {
        let first = rates(field, mode, drive, self.from, &self.begin);
        self.rates.fill(first);
    }

    fn analyze(&mut self, gauss: &Gauss) {
        for (row, coefficient) in gauss.analysis.iter().zip(&mut self.series) {
            *coefficient = [0.0; LENGTH];
            for (weight, rate) in row.iter().zip(&self.rates) {
                for (component, rate) in coefficient.iter_mut().zip(rate).take(self.length) {
                    *component += weight * rate;
                }
            }
        }
    }

    /// Returns the state at a part τ of the step, 0 to 1.
    pub(crate) fn at(&self, tau: f64) -> Vector {
        self.with_basis(&basis(tau, self.series.len()))
    }

    /// Returns the state, given the integrals of the Legendre polynomials.
    pub(crate) fn with_basis(&self, basis: &[f64; MOST_STAGES]) -> Vector {
        let mut vector = self.begin;
        for (coefficient, basis) in self.series.iter().zip(basis) {
            let basis = basis * self.size;
            for (component, coefficient) in vector.iter_mut().zip(coefficient).take(self.length) {
                *component += basis * coefficient;
            }
        }
        vector
    }

    /// Returns the error of the collocation polynomial relative to `scale`, from the tail of its Legendre
    /// series.
    pub(crate) fn error(&self, scale: &Vector) -> f64 {
        let [.., before, last] = self.series.as_slice() else { return 0.0 };
        let stages = self.series.len() as f64;
        let tails = last.iter().zip(before).zip(scale).take(self.length);
        tails
            .map(|((last, before), scale)| {
                // The last two coefficients are used because one of them may vanish by symmetry.
                let tail = last.abs().max(0.1 * before.abs());
                tail * self.size / (2.0 * stages * scale.max(f64::MIN_POSITIVE))
            })
            .fold(0.0, f64::max)
    }
}

pub(crate) fn rates(
    field: &Field<f64>,
    mode: &Mode,
    drive: &Drive<'_>,
    time: f64,
    vector: &Vector,
) -> Vector {
    let input = drive.torque(time);
    let state = state(time, vector, input);
    let (acceleration, hidden) = field.rates(&state, mode);
    let mut rates = [0.0; LENGTH];
    for (rate, value) in rates.iter_mut().zip([state.velocity, acceleration].into_iter().chain(hidden)) {
        *rate = value;
    }
    rates
}
