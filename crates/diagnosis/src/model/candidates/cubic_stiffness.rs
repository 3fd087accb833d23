//! Spring that hardens or softens.

use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, SystemEffect};

/// Spring that hardens or softens.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CubicStiffness;

impl CandidateLaw for CubicStiffness {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::CubicStiffness)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Restoring
    }

    fn is_plain(&self) -> bool {
        true
    }

    fn parameters(&self, _facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::any("coefficient")]
    }

    fn is_non_negative(&self) -> bool {
        false
    }
}
