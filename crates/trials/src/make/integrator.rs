//! Integrator of motions that is independent of both integrators of [`dynamics`]: exact steps of the linear
//! oscillator between kicks.
//!
//! A step of length h is (Strang's splitting)
//!
//! 1. hidden states over h/2 with position and velocity held, by their exact exponential;
//! 2. a kick of the velocity by the law's torque over h/2;
//! 3. the linear oscillator with its input, exactly, over h;
//! 4. 2 and 1 again, in reverse order.
//!
//! The scheme is of second order, and exact without a law. A step is at most 0.004/ω and at most a sixteenth
//! of the time between samples. The error that is first order in the ratio of the law's torque to the
//! spring's averages out over a swing, so that no phase error accumulates from it. Dry friction is never a
//! jump here: laws are continuous, with stiff hidden states, which the exponentials handle.
//!
//! # Reference
//! Strang, SIAM Journal on Numerical Analysis 5 (1968) 506; Hairer, Lubich, Wanner, Geometric Numerical
//! Integration, 2nd ed., Springer 2006, sections II.5 and III.3.

use super::error::TrialError;
use super::situation::{Motion, Situation};
use dynamics::{Nominal, Start};

/// Hidden states of a law outside the vocabulary.
pub(crate) type Hidden = [f64; 2];

/// State at which a torque is evaluated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    /// Time in seconds.
    pub(crate) time: f64,
    /// Distance from the rest angle, in rad.
    pub(crate) deflection: f64,
    /// Velocity in rad/s.
    pub(crate) velocity: f64,
    /// Hidden states of the law.
    pub(crate) hidden: Hidden,
}

/// Torque that [`dynamics`] does not have, or has by another law.
pub(crate) trait TorqueLaw {
    /// Returns the torque in the system's unit.
    fn torque(&self, moment: &Moment) -> f64;

    /// Returns the hidden states after a duration in seconds, with position and velocity held.
    fn relax(&self, moment: &Moment, _duration: f64) -> Hidden {
        moment.hidden
    }

    /// Returns the hidden states at the start.
    fn start(&self, _deflection: f64, _velocity: f64) -> Hidden {
        [0.0; 2]
    }
}

/// Largest step, in units of 1/ω.
const LARGEST_PHASE: f64 = 0.004;

/// Smallest number of steps between two samples.
const FEWEST_STEPS: usize = 16;

/// Returns the motion of each record of a situation, with the sum of several laws. `disturbance` returns, for
/// a record, a torque held from sample to sample.
pub(crate) fn motions(
    situation: &Situation,
    laws: &[&dyn TorqueLaw],
    disturbance: &dyn Fn(usize) -> Vec<f64>,
) -> Result<Vec<Motion>, TrialError> {
    let times = situation.times();
    let input = situation.input()?;
    let gain = situation.nominal.input_gain();
    Ok(situation
        .starts
        .iter()
        .enumerate()
        .map(|(record, &start)| {
            let mut held = disturbance(record);
            held.resize(times.len(), 0.0);
            if let Some(input) = &input {
                for (held, value) in held.iter_mut().zip(input.values()) {
                    *held += gain * value;
                }
            }
            motion(&situation.nominal, start, laws, &times, &held)
        })
        .collect())
}

/// Laws that act together, each with its hidden states.
struct Acting<'a>(Vec<(&'a dyn TorqueLaw, Hidden)>);

impl Acting<'_> {
    fn torque(&self, now: &Moment) -> f64 {
        self.0.iter().map(|(law, hidden)| law.torque(&Moment { hidden: *hidden, ..*now })).sum()
    }

    fn relax(&mut self, now: &Moment, duration: f64) {
        for (law, hidden) in &mut self.0 {
            *hidden = law.relax(&Moment { hidden: *hidden, ..*now }, duration);
        }
    }
}

/// Returns the motion at evenly spaced times, with a torque `held` from each time to the next.
fn motion(nominal: &Nominal, start: Start, laws: &[&dyn TorqueLaw], times: &[f64], held: &[f64]) -> Motion {
    let [first, second, ..] = *times else { return Motion::default() };
    let period = second - first;
    let steps = ((period * nominal.angular_frequency() / LARGEST_PHASE).ceil() as usize).max(FEWEST_STEPS);
    let step = period / steps as f64;
    let drift = Drift::new(nominal, step);
    let rest = nominal.rest_angle();
    let deflection = start.position - rest;
    let mut now = Moment { time: first, deflection, velocity: start.velocity, hidden: [0.0; 2] };
    let mut acting = Acting(laws.iter().map(|law| (*law, law.start(deflection, start.velocity))).collect());
    let kick = 0.5 * step / nominal.inertia();
    let mut motion = Motion { times: times.to_vec(), ..Motion::default() };
    for (&time, &held) in times.iter().zip(held) {
        motion.position.push(rest + now.deflection);
        motion.velocity.push(now.velocity);
        let spring = nominal.stiffness() * now.deflection + nominal.damping() * now.velocity;
        motion.acceleration.push((held + acting.torque(&now) - spring) / nominal.inertia());
        for number in 0..steps {
            acting.relax(&now, 0.5 * step);
            now.velocity += kick * acting.torque(&now);
            (now.deflection, now.velocity) = drift.step(now.deflection, now.velocity, held);
            now.time = time + (number + 1) as f64 * step;
            now.velocity += kick * acting.torque(&now);
            acting.relax(&now, 0.5 * step);
        }
    }
    motion
}

/// Propagator of the linear oscillator over one step with a held torque.
struct Drift {
    position: [f64; 2],
    velocity: [f64; 2],
    stiffness: f64,
}

impl Drift {
    /// Computes the propagator from the closed form of a damped oscillation; the drawn systems are
    /// underdamped and have a spring.
    fn new(nominal: &Nominal, step: f64) -> Self {
        let decay = 0.5 * nominal.damping() / nominal.inertia();
        let square = nominal.stiffness() / nominal.inertia();
        let omega = (square - decay * decay).max(f64::MIN_POSITIVE).sqrt();
        let (sine, cosine) = (omega * step).sin_cos();
        let size = (-decay * step).exp();
        let ratio = decay / omega;
        Self {
            position: [size * (cosine + ratio * sine), size * sine / omega],
            velocity: [-size * square * sine / omega, size * (cosine - ratio * sine)],
            stiffness: nominal.stiffness(),
        }
    }

    fn step(&self, deflection: f64, velocity: f64, held: f64) -> (f64, f64) {
        let shift = held / self.stiffness;
        let from = deflection - shift;
        let [a, b] = self.position;
        let [c, d] = self.velocity;
        (shift + a * from + b * velocity, c * from + d * velocity)
    }
}
