//! Coulomb friction.

use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, SystemEffect};

/// Coulomb friction.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CoulombFriction;

impl CandidateLaw for CoulombFriction {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::CoulombFriction)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Friction
    }

    fn is_plain(&self) -> bool {
        true
    }

    fn parameters(&self, _facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::strength("torque")]
    }

    fn is_non_negative(&self) -> bool {
        true
    }
}
