//! Damping without a name.

use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, SystemEffect};

/// Damping of higher order without a name: drag of another power, or a damping that grows or falls with the
/// deflection. It is not a candidate for a name, but could take the place of some (see
/// [`crate::search::nameless`]).
#[derive(Debug, Clone, Copy)]
pub(crate) struct UnlistedDamping;

impl CandidateLaw for UnlistedDamping {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::UnlistedDamping)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Unnamed
    }

    fn stands_for(&self) -> Option<EvidenceClass> {
        Some(EvidenceClass::Damping)
    }

    fn parameters(&self, _facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::any("cubic_damping"), Parameter::any("deflection_damping")]
    }

    fn is_non_negative(&self) -> bool {
        false
    }

    fn linear_places(&self) -> &'static [usize] {
        &[0, 1]
    }
}
