//! A constant torque.

use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, Nominal, SystemEffect};

/// A constant torque.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ConstantTorque;

impl CandidateLaw for ConstantTorque {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::ConstantTorque)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Preload
    }

    fn parameters(&self, _facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::any("torque")]
    }

    fn is_non_negative(&self) -> bool {
        false
    }

    /// On a spring it is a shift of the rest angle, which is part of the calibration.
    fn applies(&self, _facts: &Scales, nominal: &Nominal) -> bool {
        nominal.stiffness() <= 0.0
    }
}
