//! Damping that drifts.

use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, SystemEffect};

/// Damping that drifts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DampingDrift;

impl CandidateLaw for DampingDrift {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::DampingDrift)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Damping
    }

    fn parameters(&self, _facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::any("rate")]
    }

    fn is_non_negative(&self) -> bool {
        false
    }

    fn is_flexible(&self) -> bool {
        true
    }
}
