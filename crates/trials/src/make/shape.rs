//! Shapes of the vocabulary's effects: all their parameters but the size, which is solved for.

use super::draws::Draws;
use super::error::TrialError;
use super::situation::Situation;
use dynamics::{Active, Effect};
use std::f64::consts::{FRAC_PI_2, PI};

/// An effect whose size is open. The size is a number above 0, small for a small effect.
pub(crate) struct Shape {
    /// The effect's id.
    pub(crate) id: &'static str,
    /// A size to start from.
    pub(crate) guess: f64,
    /// The largest size that makes sense.
    pub(crate) most: f64,
    values: Box<dyn Fn(f64) -> Vec<f64>>,
}

impl Shape {
    /// The effect at a size.
    pub(crate) fn at(&self, size: f64) -> Result<Active, TrialError> {
        Ok(Active::new(self.id, &(self.values)(size))?)
    }

    /// Draws the shape of an effect whose size follows from its detectability by solving.
    ///
    /// Torques are drawn in units of the spring's at the largest swing, velocities in those of the largest
    /// velocity, times in those of the record's length: a shape then means the same for every system.
    pub(crate) fn draw(id: &str, situation: &Situation, draws: &mut Draws) -> Result<Self, TrialError> {
        let effect = Effect::find(id)?;
        let nominal = &situation.nominal;
        let (inertia, stiffness, rest) = (nominal.inertia(), nominal.stiffness(), nominal.rest_angle());
        let (omega, swing, duration) = (situation.omega(), situation.amplitude, situation.duration());
        let torque = stiffness * swing;
        let speed = omega * swing;
        // The side away from the start: a stop on the start's own side would be pressed from the beginning.
        let side = situation.starts.first().map_or(1.0, |start| -(start.position - rest).signum());
        let make = |guess: f64, most: f64, values: Box<dyn Fn(f64) -> Vec<f64>>| Self {
            id: effect.id(),
            guess,
            most,
            values,
        };
        let scaled =
            |guess: f64, most: f64, unit: f64| make(guess, most, Box::new(move |size| vec![size * unit]));
        Ok(match effect.id() {
            "coulomb_friction" => scaled(1e-3, 0.1, torque),
            "stribeck_friction" => {
                let (ratio, velocity) = (draws.uniform(1.5, 3.0), draws.uniform(0.03, 0.3) * speed);
                make(1e-3, 0.1, Box::new(move |size| vec![size * torque, ratio * size * torque, velocity]))
            }
            "quadratic_drag" => scaled(1e-3, 1.0, inertia),
            "cubic_stiffness" => scaled(1e-3, 0.4, draws.sign() * stiffness / swing.powi(2)),
            "asymmetric_stiffness" => scaled(1e-3, 0.3, draws.sign() * stiffness / swing),
            "gravity" => {
                let angle = draws.uniform(0.0, FRAC_PI_2);
                make(1e-2, 0.8, Box::new(move |size| vec![size * stiffness, angle]))
            }
            "constant_torque" => scaled(1e-3, 0.3, draws.sign() * torque),
            "backlash" => scaled(1e-3, 0.3, swing),
            "hysteresis" => {
                let displacement = draws.log_uniform(0.02, 0.3) * swing;
                make(1e-3, 0.1, Box::new(move |size| vec![size * torque, displacement]))
            }
            "end_stop" => {
                let angle = rest + side * draws.uniform(0.6, 0.9) * swing;
                let dissipation = draws.uniform(0.0, 0.3) / speed;
                make(1e-2, 1e4, Box::new(move |size| vec![angle, size * stiffness, dissipation]))
            }
            "stiffness_drift" => scaled(1e-4, 0.5, draws.sign() / duration),
            // A damping that falls must not change its sign; one that rises may rise manyfold.
            "damping_drift" if draws.chance(0.5) => scaled(1e-2, 0.95, -1.0 / duration),
            "damping_drift" => scaled(1e-2, 20.0, 1.0 / duration),
            "periodic_forcing" => {
                let below = draws.chance(0.5);
                let ratio = if below { draws.uniform(0.3, 0.8) } else { draws.uniform(1.25, 4.0) };
                let (frequency, phase) = (ratio * omega, draws.uniform(-PI, PI));
                make(1e-3, 1.0, Box::new(move |size| vec![size * torque, frequency, phase]))
            }
            "flexible_coupling" => {
                let frequency = draws.uniform(1.8, 5.0) * omega;
                let damping = 2.0 * draws.log_uniform(0.002, 0.03) * frequency;
                let values = move |size: f64| {
                    let own = size * inertia;
                    vec![own, own * frequency * frequency, own * damping]
                };
                make(1e-2, 1.0, Box::new(values))
            }
            "input_delay" => scaled(1e-2, 3.0, 1.0 / omega),
            "input_saturation" => {
                let largest = situation.excitation.map_or(0.0, |excitation| excitation.amplitude);
                make(1e-2, 0.95, Box::new(move |size| vec![largest * (1.0 - size)]))
            }
            "sensor_lag" => scaled(1e-2, 3.0, 1.0 / omega),
            "sensor_nonlinearity" => {
                let phase = draws.uniform(-PI, PI);
                make(1e-3, 0.3, Box::new(move |size| vec![size, phase]))
            }
            "sensor_drift" => scaled(1e-4, 1.0, draws.sign() * swing / duration),
            "sensor_saturation" => {
                // The range ends at the same distance from zero on both sides.
                let largest = swing + rest.abs();
                make(1e-2, 0.6, Box::new(move |size| vec![largest * (1.0 - size)]))
            }
            // A rate alone is what another stiffness and damping do to the motion; its change is not.
            "clock_drift" => {
                let (sign, rate) = (draws.sign(), draws.uniform(-0.5, 0.5));
                let values = move |size: f64| vec![rate * sign * size, sign * size / duration];
                make(1e-4, 0.1, Box::new(values))
            }
            other => return Err(TrialError::NoShape { effect: other.to_owned() }),
        })
    }
}

/// Effects of the measurement chain that are random, or do to every sample the same as noise would. Their size
/// follows from the expected sum of squares of what they do, E‖Δ‖², without projection: what a recalibration
/// absorbs of it is of the order of the number of its unknowns over that of the samples.
pub(crate) const RANDOM: &[&str] =
    &["sensor_quantization", "timestamp_jitter", "outliers", "dropouts", "timestamp_batching"];

/// A random effect as detectable as wanted where that can be had, and how detectable it is.
///
/// - `sensor_quantization`: E‖Δ‖² = n·q²/12.
/// - `timestamp_jitter`: E‖Δ‖² = σ_t²·Σθ̇²; at most 0.45 sample periods.
/// - `outliers`: E‖Δ‖² = n·p·s², with 4 to 20 wrong samples expected.
/// - `timestamp_batching`: stamps are late by anything up to an interval, so that E‖PΔ‖² ≈ T_b²/12·Σθ̇².
///   Bursts are drawn as loggers make them, 10 to 80 ms apart, whatever was wanted: they are as detectable
///   as they are.
/// - `dropouts` change no value. Their share of lost samples is 0.2 % times the detectability wanted, at
///   most 30 %, and the detectability given is 0.
pub(crate) fn random_effect(
    id: &str,
    situation: &Situation,
    square_velocities: f64,
    white: f64,
    wanted: f64,
    draws: &mut Draws,
) -> Result<(Active, f64), TrialError> {
    let samples = (situation.sampling.samples * situation.starts.len()) as f64;
    let period = 1.0 / situation.sampling.rate_hz;
    let sum = wanted * white;
    let speed = square_velocities.sqrt().max(f64::MIN_POSITIVE);
    let (values, detectability) = match id {
        "sensor_quantization" => (vec![sum * (12.0 / samples).sqrt()], wanted),
        "timestamp_jitter" => {
            let deviation = (sum / speed).min(0.45 * period);
            (vec![deviation], deviation * speed / white)
        }
        "outliers" => {
            let count = draws.uniform(4.0, 20.0);
            (vec![count / samples, sum / count.sqrt()], wanted)
        }
        "timestamp_batching" => {
            let most = (0.1 * situation.duration()).max(4.0 * period);
            let interval = draws.uniform(0.01, 0.08).clamp(2.0 * period, most);
            (vec![interval, draws.uniform(0.0, 0.1) * interval], interval / 12.0_f64.sqrt() * speed / white)
        }
        _ => (vec![(0.002 * wanted).min(0.3), draws.uniform(1.0, 8.0)], 0.0),
    };
    Ok((Active::new(id, &values)?, detectability))
}
