//! Effects of the vocabulary by other laws, in motions by another integrator, with correlated disturbances.

use super::case::{ATTEMPTS, Case, Job, Setup};
use super::draws::Draws;
use super::error::TrialError;
use super::integrator::{TorqueLaw, motions};
use super::laws::{
    BoucWen, DragPower, Drifting, ExponentialDrift, ExponentialSpring, HertzStop, LuGre, RoundedBacklash,
    SineSpring, WanderingForcing,
};
use super::own_record::{OpenLaw, Told, written};
use super::plan::TrialPlan;
use super::recalibration::Absorbed;
use super::situation::{Motion, Situation};
use crate::HiddenEffect;
use dynamics::Start;
use seed::Seed;
use std::f64::consts::PI;

/// What is hidden in turn, and the law by which it acts.
pub(crate) const EFFECTS: &[(&str, &str)] = &[
    ("coulomb_friction", "LuGre"),
    ("stribeck_friction", "LuGre"),
    ("quadratic_drag", "drag of another power"),
    ("cubic_stiffness", "sine spring"),
    ("asymmetric_stiffness", "exponential spring"),
    ("backlash", "rounded dead zone"),
    ("hysteresis", "Bouc-Wen"),
    ("end_stop", "Hertzian contact"),
    ("stiffness_drift", "drift that settles"),
    ("damping_drift", "drift that settles"),
    ("periodic_forcing", "wandering phase"),
];

/// Root mean square of what the disturbing torque does to the position, in units of the sensor's white
/// noise: from, to.
const DISTURBANCE: [f64; 2] = [0.02, 0.08];

/// Standard deviation of the correlated part of the sensor's noise, in the same units.
const CORRELATED: [f64; 2] = [0.03, 0.15];

/// A case of the bank.
pub(crate) fn make(plan: &TrialPlan, job: Job, id: String) -> Result<Case, TrialError> {
    let (at, wanted) = plan.turn(job.number, EFFECTS.len());
    let (effect, law) = EFFECTS.get(at).copied().unwrap_or_default();
    let kind_of_motion = job.free_motions(plan);
    for attempt in 0..ATTEMPTS {
        let setup = Setup::draw(plan, job, attempt, kind_of_motion, &[])?;
        let drawn = draw(effect, &setup.situation, &mut Draws::new(&setup.seed.child(effect)));
        let Some(sized) = drawn.open.sized(&setup, wanted, Absorbed::BY_RECALIBRATION)? else { continue };
        let mut draws = Draws::new(&setup.seed.child("disturbance"));
        let disturbance = disturbance(&setup.situation, &setup.seed, &mut draws)?;
        let mut motions = motions(&setup.situation, &[sized.law.as_ref()], &disturbance)?;
        add_correlated_noise(&setup.situation, &mut motions, &mut draws);
        let told = Told {
            effects: vec![HiddenEffect {
                id: effect.to_owned(),
                parameters: (drawn.parameters)(sized.size),
                law: law.to_owned(),
                detectability: sized.detectability,
                floors: None,
            }],
            made: format!("{effect} by splitting: {}", drawn.words),
            ..Told::default()
        };
        return written(plan, job, id, &setup, &motions, told);
    }
    Err(TrialError::OutOfReach { effect: effect.to_owned(), wanted, attempts: ATTEMPTS })
}

/// A law with its shape drawn.
pub(crate) struct Drawn {
    pub(crate) open: OpenLaw,
    /// Parameters by the vocabulary's law, or the nearest to them, at a size.
    pub(crate) parameters: Box<dyn Fn(f64) -> Vec<f64>>,
    pub(crate) words: String,
}

pub(crate) fn drawn<L: TorqueLaw + 'static>(
    guess: f64,
    most: f64,
    law: impl Fn(f64) -> L + 'static,
    parameters: impl Fn(f64) -> Vec<f64> + 'static,
    words: String,
) -> Drawn {
    let law = move |size: f64| -> Box<dyn TorqueLaw> { Box::new(law(size)) };
    Drawn { open: OpenLaw { guess, most, law: Box::new(law) }, parameters: Box::new(parameters), words }
}

pub(crate) fn draw(effect: &str, situation: &Situation, draws: &mut Draws) -> Drawn {
    let nominal = situation.nominal;
    let (inertia, stiffness, rest) = (nominal.inertia(), nominal.stiffness(), nominal.rest_angle());
    let (omega, swing) = (situation.omega(), situation.amplitude);
    let (torque, speed) = (stiffness * swing, omega * swing);
    match effect {
        "coulomb_friction" | "stribeck_friction" => {
            let ratio = if effect == "coulomb_friction" { 1.0 } else { draws.uniform(1.5, 3.0) };
            let velocity = draws.uniform(0.03, 0.3) * speed;
            // Bristles that bend more are hysteresis, and rightly called so.
            let bend = draws.log_uniform(1e-5, 1e-4) * swing;
            let law = move |size: f64| LuGre {
                torque: size * torque,
                static_torque: ratio * size * torque,
                velocity,
                bend,
            };
            let parameters = move |size: f64| match ratio {
                1.0 => vec![size * torque],
                _ => vec![size * torque, ratio * size * torque, velocity],
            };
            drawn(1e-3, 0.1, law, parameters, format!("bristles bend by {bend:.2e} rad"))
        }
        "quadratic_drag" => {
            let (exponent, velocity) = (draws.uniform(1.8, 2.2), 0.5 * speed);
            let law = move |size: f64| DragPower { coefficient: size * inertia, exponent, velocity };
            drawn(1e-3, 1.0, law, move |size| vec![size * inertia], format!("exponent {exponent:.3}"))
        }
        "cubic_stiffness" => {
            let (sign, steepness) = (draws.sign(), draws.uniform(0.5, 1.5) / swing);
            let hyperbolic = draws.chance(0.5);
            let coefficient = move |size: f64| sign * size * stiffness / (swing * swing);
            let law = move |size: f64| SineSpring { coefficient: coefficient(size), steepness, hyperbolic };
            let words = format!("steepness {steepness:.3}, hyperbolic {hyperbolic}");
            drawn(1e-3, 0.4, law, move |size| vec![coefficient(size)], words)
        }
        "asymmetric_stiffness" => {
            // A steeper one has as much of a cubic spring in it, which together is gravity.
            let (sign, steepness) = (draws.sign(), draws.sign() * draws.uniform(0.05, 0.2) / swing);
            let coefficient = move |size: f64| sign * size * stiffness / swing;
            let law = move |size: f64| ExponentialSpring { coefficient: coefficient(size), steepness };
            drawn(1e-3, 0.3, law, move |size| vec![coefficient(size)], format!("steepness {steepness:.3}"))
        }
        "backlash" => {
            let law = move |size: f64| RoundedBacklash { stiffness, half_width: size * swing };
            drawn(
                1e-3,
                0.3,
                law,
                move |size| vec![size * swing],
                "edges round over the half width".to_owned(),
            )
        }
        "hysteresis" => {
            let (displacement, sharpness) = (draws.log_uniform(0.02, 0.3) * swing, draws.uniform(1.5, 4.0));
            let law = move |size: f64| BoucWen { torque: size * torque, displacement, sharpness };
            let parameters = move |size: f64| vec![size * torque, displacement];
            drawn(1e-3, 0.1, law, parameters, format!("sharpness {sharpness:.2}"))
        }
        "end_stop" => {
            let side = situation.starts.first().map_or(1.0, |start| -(start.position - rest).signum());
            let deflection = side * draws.uniform(0.6, 0.9) * swing;
            let dissipation = draws.uniform(0.0, 0.3) / speed;
            let hertz = move |size: f64| size * stiffness / swing.sqrt();
            let law = move |size: f64| HertzStop { deflection, stiffness: hertz(size), dissipation };
            // The linear contact with the same torque at a depth of a tenth of the swing.
            let linear = move |size: f64| hertz(size) * (0.1 * swing).sqrt();
            drawn(
                1e-2,
                1e4,
                law,
                move |size| vec![rest + deflection, linear(size), dissipation],
                "power 3/2".to_owned(),
            )
        }
        "stiffness_drift" | "damping_drift" => drift(effect, situation, draws),
        _ => forcing(situation, draws),
    }
}

/// A drift that settles, in stiffness or damping.
fn drift(effect: &str, situation: &Situation, draws: &mut Draws) -> Drawn {
    let nominal = situation.nominal;
    let (stiffness, duration) = (nominal.stiffness(), situation.duration());
    // One that settles as fast as the amplitude decays is what a cubic spring or another friction does.
    let settling = draws.uniform(1.5, 5.0) * duration;
    let damping = nominal.damping();
    let of_stiffness = effect == "stiffness_drift";
    let sign = if of_stiffness { draws.sign() } else { 1.0 };
    let rate = move |size: f64| sign * size / duration;
    let law = move |size: f64| ExponentialDrift {
        of: if of_stiffness { Drifting::Stiffness(stiffness) } else { Drifting::Damping(damping) },
        rate: rate(size),
        settling,
    };
    let (guess, most) = if of_stiffness { (1e-4, 0.5) } else { (1e-2, 40.0) };
    drawn(guess, most, law, move |size| vec![rate(size)], format!("settles in {settling:.2} s"))
}

/// A periodic torque whose frequency wanders.
fn forcing(situation: &Situation, draws: &mut Draws) -> Drawn {
    let (omega, duration) = (situation.omega(), situation.duration());
    let torque = situation.nominal.stiffness() * situation.amplitude;
    let below = draws.chance(0.5);
    let ratio = if below { draws.uniform(0.3, 0.8) } else { draws.uniform(1.25, 4.0) };
    let (frequency, phase) = (ratio * omega, draws.uniform(-PI, PI));
    let wander = draws.uniform(0.1, 0.6);
    let wander_frequency = draws.uniform(1.0, 6.0) * PI / duration;
    let law = move |size: f64| WanderingForcing {
        torque: size * torque,
        frequency,
        phase,
        wander,
        wander_frequency,
    };
    let parameters = move |size: f64| vec![size * torque, frequency, phase];
    drawn(1e-3, 1.0, law, parameters, format!("phase wanders by {wander:.2} rad"))
}

/// A first-order autoregressive sequence of unit variance at the samples, with a correlation time in seconds.
fn autoregressive(situation: &Situation, correlation: f64, draws: &mut Draws) -> Vec<f64> {
    let keep = (-1.0 / (situation.sampling.rate_hz * correlation)).exp();
    let new = (1.0 - keep * keep).sqrt();
    let mut now = draws.normal();
    (0..situation.sampling.samples)
        .map(|_| {
            let value = now;
            now = keep * now + new * draws.normal();
            value
        })
        .collect()
}

/// A disturbing torque for each record, scaled by what it does to the oscillator at rest.
fn disturbance(
    situation: &Situation,
    seed: &Seed,
    draws: &mut Draws,
) -> Result<impl Fn(usize) -> Vec<f64> + use<>, TrialError> {
    let correlation = draws.log_uniform(0.05, 2.0) / situation.omega();
    let wanted = draws.uniform(DISTURBANCE[0], DISTURBANCE[1]) * situation.noise;
    let unit: Vec<Vec<f64>> = (0..situation.starts.len())
        .map(|record| {
            let mut own = Draws::new(&seed.child("disturbance").child(&format!("record {record}")));
            let scale = situation.nominal.stiffness();
            autoregressive(situation, correlation, &mut own).into_iter().map(|value| scale * value).collect()
        })
        .collect();
    let rest = situation.nominal.rest_angle();
    let still = Situation {
        starts: vec![Start::release(rest); situation.starts.len()],
        excitation: None,
        ..situation.clone()
    };
    let held = |record: usize| unit.get(record).cloned().unwrap_or_default();
    let shaken = motions(&still, &[], &held)?;
    let squares: Vec<f64> =
        shaken.iter().flat_map(|motion| &motion.position).map(|position| (position - rest).powi(2)).collect();
    let spread = (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt();
    let factor = wanted / spread.max(f64::MIN_POSITIVE);
    Ok(move |record: usize| {
        unit.get(record).into_iter().flatten().map(|value| factor * value).collect::<Vec<f64>>()
    })
}

/// Adds the correlated part of the sensor's noise.
fn add_correlated_noise(situation: &Situation, motions: &mut [Motion], draws: &mut Draws) {
    let correlation = draws.log_uniform(0.02, 0.5);
    let size = draws.uniform(CORRELATED[0], CORRELATED[1]) * situation.noise;
    for motion in motions {
        let noise = autoregressive(situation, correlation, draws);
        for (position, noise) in motion.position.iter_mut().zip(noise) {
            *position += size * noise;
        }
    }
}
