//! Quadratic drag.

use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, SystemEffect};

/// Quadratic drag.
#[derive(Debug, Clone, Copy)]
pub(crate) struct QuadraticDrag;

impl CandidateLaw for QuadraticDrag {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::QuadraticDrag)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Damping
    }

    fn is_plain(&self) -> bool {
        true
    }

    fn parameters(&self, _facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::strength("coefficient")]
    }

    fn is_non_negative(&self) -> bool {
        true
    }
}
