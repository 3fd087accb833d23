//! Effects that the vocabulary does not have.
//!
//! Their sizes are those of what is left when not only a recalibration but also the effects nearest to them
//! have taken away what they can: else `unknown` would be no better an answer than the stand-in.
//!
//! A stiffness that depends on the velocity is not among them: on a single oscillation it is a cubic
//! stiffness but for its small third harmonic, so that the vocabulary's answer would not be wrong.

use super::case::{ATTEMPTS, Case, Job, Setup};
use super::draws::Draws;
use super::error::TrialError;
use super::integrator::motions;
use super::laws::{Cogging, Maxwell, Parametric, PositionDamping};
use super::own_record::{OpenLaw, Told, written};
use super::plan::TrialPlan;
use super::recalibration::Absorbed;
use super::situation::Situation;
use crate::Foreign;
use std::f64::consts::PI;

/// What is hidden in turn, and what the vocabulary nearest to it absorbs beside a recalibration.
pub(crate) const KINDS: &[(&str, Absorbed)] = &[
    (
        "cogging",
        Absorbed { stand_ins: &["cubic_stiffness", "asymmetric_stiffness"], ..Absorbed::BY_RECALIBRATION },
    ),
    (
        "maxwell",
        Absorbed { sensor_drift: true, stand_ins: &["asymmetric_stiffness"], ..Absorbed::BY_RECALIBRATION },
    ),
    (
        "parametric",
        Absorbed { stand_ins: &["stiffness_drift", "cubic_stiffness"], ..Absorbed::BY_RECALIBRATION },
    ),
    (
        "position_damping",
        Absorbed { stand_ins: &["quadratic_drag", "damping_drift"], ..Absorbed::BY_RECALIBRATION },
    ),
];

/// A case of the bank.
pub(crate) fn make(plan: &TrialPlan, job: Job, id: String) -> Result<Case, TrialError> {
    let (at, wanted) = plan.turn(job.number, KINDS.len());
    let (kind, absorbed) = KINDS.get(at).copied().unwrap_or(("", Absorbed::BY_RECALIBRATION));
    let kind_of_motion = job.free_motions(plan);
    for attempt in 0..ATTEMPTS {
        let setup = Setup::draw(plan, job, attempt, kind_of_motion, &[])?;
        let (law, words) = draw(kind, &setup.situation, &mut Draws::new(&setup.seed.child(kind)));
        let Some(sized) = law.sized(&setup, wanted, absorbed)? else { continue };
        let motions = motions(&setup.situation, &[sized.law.as_ref()], &|_| Vec::new())?;
        let foreign = Foreign {
            law: format!("{kind}: {words}, size {:.3e} (detectability beyond its stand-ins)", sized.size),
            detectability: sized.detectability,
        };
        let told = Told { foreign: Some(foreign), made: format!("{kind} by splitting"), ..Told::default() };
        return written(plan, job, id, &setup, &motions, told);
    }
    Err(TrialError::OutOfReach { effect: kind.to_owned(), wanted, attempts: ATTEMPTS })
}

/// A law with its shape drawn, and the shape in words.
pub(crate) fn draw(kind: &str, situation: &Situation, draws: &mut Draws) -> (OpenLaw, String) {
    let nominal = situation.nominal;
    let (stiffness, damping) = (nominal.stiffness(), nominal.damping());
    let (omega, swing, duration) = (situation.omega(), situation.amplitude, situation.duration());
    match kind {
        "cogging" => {
            let (teeth, phase) = ((8 + draws.below(17)) as f64, draws.uniform(-PI, PI));
            let law = move |size: f64| -> Box<dyn super::integrator::TorqueLaw> {
                Box::new(Cogging { torque: size * stiffness * swing, teeth, phase })
            };
            (OpenLaw { guess: 1e-3, most: 0.5, law: Box::new(law) }, format!("{teeth} a turn"))
        }
        "maxwell" => {
            let time = draws.uniform(0.08, 0.4) * duration;
            let law = move |size: f64| -> Box<dyn super::integrator::TorqueLaw> {
                Box::new(Maxwell { stiffness: size * stiffness, time })
            };
            (OpenLaw { guess: 1e-3, most: 1.0, law: Box::new(law) }, format!("relaxes in {time:.2} s"))
        }
        "parametric" => {
            // Away from twice the natural frequency, where it would grow without bound.
            let ratio = if draws.chance(0.5) { draws.uniform(0.02, 0.5) } else { draws.uniform(0.6, 1.4) };
            let phase = draws.uniform(-PI, PI);
            let law = move |size: f64| -> Box<dyn super::integrator::TorqueLaw> {
                Box::new(Parametric { stiffness: size * stiffness, frequency: ratio * omega, phase })
            };
            (
                OpenLaw { guess: 1e-3, most: 0.3, law: Box::new(law) },
                format!("{ratio:.3} of the natural frequency"),
            )
        }
        _ => {
            let law = move |size: f64| -> Box<dyn super::integrator::TorqueLaw> {
                Box::new(PositionDamping { coefficient: size * damping / (swing * swing) })
            };
            (OpenLaw { guess: 1e-2, most: 100.0, law: Box::new(law) }, "grows with the square".to_owned())
        }
    }
}
