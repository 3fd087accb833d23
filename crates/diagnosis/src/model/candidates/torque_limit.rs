//! Servo whose whole torque is limited.

use super::{CandidateLaw, EvidenceClass, Parameter, grid, has_drive};
use crate::data::scales::Scales;
use dynamics::{Effect, Nominal, SystemEffect};

/// Initial limits, relative to the drive's largest torque without a limit.
const LIMITS: [f64; 4] = [0.9, 0.7, 0.5, 0.3];

/// Limits far below that torque.
const DENSE_LIMITS: [f64; 8] = [0.95, 0.85, 0.7, 0.55, 0.42, 0.32, 0.24, 0.18];

/// Servo whose whole torque is limited.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TorqueLimit;

impl CandidateLaw for TorqueLimit {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::TorqueLimit)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Actuator
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::shape("torque", 1e-2 * facts.drive_torque, facts.drive_torque)]
    }

    /// At some torque it does what friction does to most motions.
    fn is_flexible(&self) -> bool {
        true
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    fn applies(&self, facts: &Scales, nominal: &Nominal) -> bool {
        has_drive(facts, nominal)
    }

    fn shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        grid(facts.drive_torque, &LIMITS, |torque| vec![torque])
    }

    fn dense_shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        grid(facts.drive_torque, &DENSE_LIMITS, |torque| vec![torque])
    }

    /// The shape is the parameter itself.
    fn linear_places(&self) -> &'static [usize] {
        &[]
    }
}
