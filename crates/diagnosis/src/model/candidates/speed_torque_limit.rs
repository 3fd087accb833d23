//! Servo whose torque is limited by its speed.

use super::torque_limit::TorqueLimit;
use super::{CandidateLaw, EvidenceClass, Parameter, has_drive};
use crate::data::scales::Scales;
use dynamics::{Effect, Nominal, SystemEffect};

/// Initial torques at rest, relative to the drive's largest torque without a limit, each with a no-load speed
/// relative to the speed of a swing as large as the record's.
const LIMITS: [(f64, f64); 5] = [(1.0, 0.3), (1.0, 0.8), (0.6, 0.3), (0.6, 0.8), (0.35, 0.5)];

/// Torques and no-load speeds of a strong limit, each with each.
const DENSE_TORQUES: [f64; 5] = [1.5, 1.0, 0.7, 0.47, 0.32];
const DENSE_SPEEDS: [f64; 5] = [0.15, 0.25, 0.4, 0.63, 1.0];

/// Servo whose torque is limited by its speed: the largest torque at rest, and the speed at which none is left.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SpeedTorqueLimit;

/// Returns shapes in the scales of the records.
fn at(parts: &[(f64, f64)], facts: &Scales) -> Vec<Vec<f64>> {
    let shape = |(torque, speed): &(f64, f64)| vec![torque * facts.drive_torque, speed * facts.speed];
    parts.iter().map(shape).collect()
}

impl CandidateLaw for SpeedTorqueLimit {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::SpeedTorqueLimit)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Actuator
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        vec![
            Parameter::shape("torque", 1e-2 * facts.drive_torque, 10.0 * facts.drive_torque),
            Parameter::shape("no_load_speed", 0.02 * facts.speed, 20.0 * facts.speed),
        ]
    }

    /// At some torque it does what friction or drag does to most motions.
    fn is_flexible(&self) -> bool {
        true
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    fn applies(&self, facts: &Scales, nominal: &Nominal) -> bool {
        has_drive(facts, nominal)
    }

    /// At a far higher no-load speed it is a limit of the torque alone.
    fn generalizes(&self) -> Option<&'static dyn CandidateLaw> {
        Some(&TorqueLimit)
    }

    fn shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        at(&LIMITS, facts)
    }

    fn dense_shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        let pairs =
            DENSE_TORQUES.iter().flat_map(|torque| DENSE_SPEEDS.iter().map(|speed| (*torque, *speed)));
        at(&pairs.collect::<Vec<_>>(), facts)
    }

    /// The shapes are the parameters themselves.
    fn linear_places(&self) -> &'static [usize] {
        &[]
    }
}
