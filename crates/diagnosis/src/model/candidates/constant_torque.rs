//! A constant torque.
//!
//! On a linear spring it is a shift of the rest angle, which is part of the calibration, and gains nothing beside it. It shows where
//! something else keeps its place: a play, a stop, a spring that bends.

use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, SystemEffect};

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
}
