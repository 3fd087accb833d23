//! Stressed cases: effects of the vocabulary by other laws, in motions of another integrator, with correlated
//! disturbances.

#![allow(clippy::indexing_slicing, reason = "there is a torque for each start")]

use super::own_record::{Told, written};
use crate::effects::by_other_laws;
use crate::make::case::Case;
use crate::make::draws::Draws;
use crate::make::error::TrialError;
use crate::make::integrator::motions;
use crate::make::job::Job;
use crate::make::plan::TrialPlan;
use crate::make::recalibration::Absorbed;
use crate::make::setup::{ATTEMPTS, Setup};
use crate::make::situation::{Motion, Situation};
use crate::{Bank, HiddenEffect};
use dynamics::Start;
use seed::Seed;

/// Root mean square displacement caused by the disturbing torque, in units of the sensor's white noise: from,
/// to.
const DISTURBANCE: [f64; 2] = [0.02, 0.08];

/// Standard deviation of the correlated part of the sensor's noise, in the same units.
const CORRELATED: [f64; 2] = [0.03, 0.15];

/// Makes a case of the bank.
pub(crate) fn make(plan: &TrialPlan, job: Job, id: String) -> Result<Case, TrialError> {
    let mut hidden = by_other_laws();
    hidden.retain(|(effect, _)| effect.is_hidden_in(Bank::Stressed));
    let ((effect, other), wanted) = plan.turn(job.number, &hidden)?;
    let kind_of_motion = job.free_motions(plan.seed);
    for attempt in 0..ATTEMPTS {
        let setup = Setup::draw(plan, job, attempt, kind_of_motion, &[])?;
        let drawn = (other.draw)(&setup.situation, &mut Draws::new(&setup.seed.child(effect.id())));
        let Some(sized) = setup.sized(&drawn.open, wanted, Absorbed::BY_RECALIBRATION)? else { continue };
        let mut draws = Draws::new(&setup.seed.child("disturbance"));
        let disturbance = disturbance(&setup.situation, &setup.seed, &mut draws)?;
        let mut motions = motions(&setup.situation, &[sized.law.as_ref()], &disturbance)?;
        add_correlated_noise(&setup.situation, &mut motions, &mut draws);
        let told = Told {
            effects: vec![HiddenEffect {
                id: effect.id().to_owned(),
                parameters: (drawn.parameters)(sized.size),
                law: other.name.to_owned(),
                detectability: sized.detectability,
                floors: None,
            }],
            made: format!("{} by splitting: {}", effect.id(), drawn.words),
            ..Told::default()
        };
        return written(plan, job, id, &setup, &motions, told);
    }
    Err(TrialError::OutOfReach { effect: effect.id().to_owned(), wanted, attempts: ATTEMPTS })
}

/// Draws a first-order autoregressive sequence of unit variance at the samples, with a correlation time in
/// seconds.
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

/// Draws a disturbing torque for each record, scaled by the displacement that it causes in the oscillator at
/// rest.
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
    let held = |record: usize| unit[record].clone();
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
