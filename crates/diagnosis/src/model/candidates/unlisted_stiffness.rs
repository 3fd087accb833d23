//! Stiffness without a name.

use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, SystemEffect};

/// Nonlinear spring of another power than the square or the cube, without a name. It is not a candidate for a
/// name, but could take the place of some (see [`crate::search::nameless`]).
#[derive(Debug, Clone, Copy)]
pub(crate) struct UnlistedStiffness;

impl CandidateLaw for UnlistedStiffness {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::UnlistedStiffness)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Unnamed
    }

    fn stands_for(&self) -> Option<EvidenceClass> {
        Some(EvidenceClass::Restoring)
    }

    fn parameters(&self, _facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::any("coefficient")]
    }

    fn is_non_negative(&self) -> bool {
        false
    }
}
