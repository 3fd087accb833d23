//! Damping that grows away from the middle.

use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, SystemEffect};

/// Damping that grows away from the middle, or falls there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SineDrag;

impl CandidateLaw for SineDrag {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::SineDrag)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Damping
    }

    fn parameters(&self, _facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::any("coefficient")]
    }

    fn is_non_negative(&self) -> bool {
        false
    }
}
