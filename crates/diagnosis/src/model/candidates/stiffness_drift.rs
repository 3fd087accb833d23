//! Stiffness that drifts.

use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, Nominal, SystemEffect};

/// Stiffness that drifts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StiffnessDrift;

impl CandidateLaw for StiffnessDrift {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::StiffnessDrift)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Drift
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

    fn applies(&self, _facts: &Scales, nominal: &Nominal) -> bool {
        nominal.stiffness() > 0.0
    }
}
