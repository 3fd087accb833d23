//! Constant torque.
//!
//! On a linear spring it shifts the rest angle, which is part of the calibration, and gains nothing beside
//! it. It shows if another effect has a fixed place: a play, a stop, a nonlinear spring.

use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, SystemEffect};

/// Constant torque.
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
}
