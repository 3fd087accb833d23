//! Spring that is stiffer to one side.

use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, SystemEffect};

/// Spring that is stiffer to one side.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AsymmetricStiffness;

impl CandidateLaw for AsymmetricStiffness {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::AsymmetricStiffness)
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
