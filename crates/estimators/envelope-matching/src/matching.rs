//! Matching as a least-squares problem.

use crate::dual::Dual;
use crate::oscillator::{Oscillator, Peak, Viscous};
use envelope::Envelope;
use estimator::{FitError, Scaling};
use nalgebra::{Matrix2, Vector2};
use std::f64::consts::TAU;

/// Fewest periods that are simulated.
const FEWEST_PERIODS: f64 = 4.0;

/// Largest change of ln A within a simulated period, so that the motion stays an oscillation.
const MOST_CHANGE_PER_PERIOD: f64 = 2.0;

/// Rounding error of ln A after the simulation of some tens of periods.
const SIMULATION_NOISE: f64 = 1e-13;

/// Most periods, however much ln A changes: a simulation of a few seconds. A longer one is not attempted.
const LIMIT: f64 = 1e6;

/// Measured envelope in scaled units, τ in 0..1 and z, with the oscillator that is matched to it.
///
/// The parameters are z at time 0, and λ·T/spread with T the record's length.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Matching {
    pub(crate) scaling: Scaling,
    times: Vec<f64>,
    targets: Vec<f64>,
    /// Angular frequency per record length.
    omega: f64,
    steps_per_period: f64,
}

/// Sum of squared residuals, with the terms that Gauss–Newton needs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Linearized {
    pub(crate) loss: f64,
    /// Normal matrix JᵀJ.
    pub(crate) normal: Matrix2<f64>,
    /// Half the gradient of the loss, Jᵀr.
    pub(crate) gradient: Vector2<f64>,
    /// Simulated envelope at the measured times, scaled.
    pub(crate) fitted: Vec<f64>,
}

impl Matching {
    pub(crate) fn new(
        envelope: &Envelope,
        steps_per_period: usize,
        most_periods: usize,
    ) -> Result<Self, FitError> {
        let scaling = Scaling::of(envelope)?;
        // The envelope of a linear oscillator does not depend on its frequency. So the frequency may differ
        // from the measured one if the record is too long to simulate, or too short for a second peak.
        let fewest = FEWEST_PERIODS.max(4.0 * scaling.spread() / MOST_CHANGE_PER_PERIOD).min(LIMIT);
        let periods =
            (envelope.omega_rad_s() * scaling.duration() / TAU).min(most_periods as f64).max(fewest);
        Ok(Self {
            scaling,
            times: scaling.unit_times(envelope),
            targets: scaling.scaled_logs(envelope),
            omega: TAU * periods,
            steps_per_period: steps_per_period as f64,
        })
    }

    /// Returns the number of measured peaks.
    pub(crate) fn len(&self) -> usize {
        self.targets.len()
    }

    /// Returns the rounding error of ln A after a simulation, scaled.
    pub(crate) fn simulation_noise(&self) -> f64 {
        SIMULATION_NOISE / self.scaling.spread()
    }

    /// Returns the loss of a match that is exact up to rounding.
    pub(crate) fn rounding(&self) -> f64 {
        let digit = self.simulation_noise()
            + 4.0 * f64::EPSILON * (1.0 + (self.scaling.mean() / self.scaling.spread()).abs());
        self.len() as f64 * digit * digit
    }

    /// Simulates and compares. `None` if the simulation is not finite.
    pub(crate) fn linearize(&self, parameters: &Vector2<f64>) -> Option<Linearized> {
        let peaks = self.simulate(Dual::variable(parameters.y * self.scaling.spread()), 1.0)?;
        let mut normal = Matrix2::zeros();
        let mut gradient = Vector2::zeros();
        let mut loss = 0.0;
        let mut fitted = Vec::with_capacity(self.len());
        for (log_height, target) in read(&peaks, &self.times).zip(&self.targets) {
            let value = parameters.x + log_height.value / self.scaling.spread();
            // The derivative is by λ·T/spread: both scales cancel.
            let row = Vector2::new(1.0, log_height.slope);
            let residual = value - target;
            fitted.push(value);
            loss += residual * residual;
            gradient += row * residual;
            normal += row * row.transpose();
        }
        let finite = loss.is_finite() && normal.iter().chain(&gradient).all(|entry| entry.is_finite());
        (finite && fitted.len() == self.len()).then_some(Linearized { loss, normal, gradient, fitted })
    }
}

/// Scaled envelope at a time, with its derivatives by the parameters.
pub(crate) type Reading = (f64, Vector2<f64>);

impl Matching {
    /// Simulates the peaks of the oscillator, released at time 0, over `duration` record lengths.
    fn simulate(&self, rate: Dual, duration: f64) -> Option<Vec<Peak>> {
        let oscillator = Oscillator {
            stiffness: Dual::constant(self.omega * self.omega) + rate * rate,
            damping: Viscous { rate },
        };
        oscillator.peaks(duration, TAU / self.omega / self.steps_per_period)
    }

    /// Returns the simulated envelope at times τ in any order, within the record or beyond it. After the
    /// record the simulation continues; before it the motion is followed backward in time, where the damping
    /// adds energy. `None` for a time that the simulation does not reach: it ends after a million periods.
    pub(crate) fn readings(&self, parameters: &Vector2<f64>, times: &[f64]) -> Vec<Option<Reading>> {
        let mut found = vec![None; times.len()];
        let rate = Dual::variable(parameters.y * self.scaling.spread());
        for (rate, way) in [(rate, 1.0), (-rate, -1.0)] {
            let asked = times.iter().map(|time| time * way).enumerate();
            let reachable = |time: &f64| *time >= 0.0 && time * self.omega <= TAU * LIMIT;
            let mut asked: Vec<(usize, f64)> = asked.filter(|(_, time)| reachable(time)).collect();
            asked.sort_by(|(_, one), (_, other)| one.total_cmp(other));
            let (places, asked): (Vec<usize>, Vec<f64>) = asked.into_iter().unzip();
            let Some(last) = asked.last() else { continue };
            let Some(peaks) = self.simulate(rate, last.max(1.0)) else { continue };
            for (place, log_height) in places.into_iter().zip(read(&peaks, &asked)) {
                let value = parameters.x + log_height.value / self.scaling.spread();
                if let Some(entry) = found.get_mut(place) {
                    *entry = Some((value, Vector2::new(1.0, log_height.slope)));
                }
            }
        }
        found
    }
}

/// Evaluates the simulated envelope at increasing times, by linear interpolation of ln A between peaks.
fn read<'a>(peaks: &'a [Peak], times: &'a [f64]) -> impl Iterator<Item = Dual> + 'a {
    let mut spans = peaks.iter().zip(peaks.iter().skip(1)).peekable();
    times.iter().map_while(move |&time| {
        while spans.next_if(|(_, after)| after.time.value < time).is_some() {}
        let (before, after) = spans.peek()?;
        let share = (Dual::constant(time) - before.time) / (after.time - before.time);
        Some(before.log_height + share * (after.log_height - before.log_height))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matching() -> Matching {
        let times: Vec<f64> = [0.0, 0.31, 0.55, 0.9, 1.13, 1.49].to_vec();
        let logs = vec![0.2, 0.1, 0.05, -0.1, -0.2, -0.22];
        Matching::new(&Envelope::new(times, logs, 21.0).unwrap(), 8, 1000).unwrap()
    }

    #[test]
    fn the_derivatives_are_those_of_differences() {
        let (at, step) = (Vector2::new(0.3, 1.2), 1e-2);
        let matching = matching();
        let here = matching.linearize(&at).unwrap();
        for (axis, unit) in [Vector2::x(), Vector2::y()].into_iter().enumerate() {
            let loss = |way: f64| matching.linearize(&(at + unit * way)).unwrap().loss;
            let slope = (loss(step) - loss(-step)) / (2.0 * step);
            assert!((here.gradient[axis] - slope / 2.0).abs() < 1e-8, "{axis}");
            let curvature = (loss(step) - 2.0 * here.loss + loss(-step)) / (step * step);
            // The residuals are linear in the parameters up to the error of the integrator.
            assert!((here.normal[(axis, axis)] / curvature * 2.0 - 1.0).abs() < 1e-5, "{axis} {curvature}");
        }
    }

    #[test]
    fn the_simulated_envelope_is_read_between_its_peaks() {
        let at = |time: f64, log: f64| Peak { time: Dual::constant(time), log_height: Dual::constant(log) };
        let peaks = [at(0.0, 0.0), at(1.0, -1.0), at(2.0, -4.0)];
        let found: Vec<f64> = read(&peaks, &[0.0, 0.5, 1.0, 1.5, 2.0, 2.1]).map(|log| log.value).collect();
        assert_eq!(found, [0.0, -0.5, -1.0, -2.5, -4.0]);
    }
}
