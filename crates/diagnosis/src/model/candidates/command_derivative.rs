//! Command whose derivative acts beside it.

use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, Nominal, SystemEffect};

/// Command whose derivative acts beside it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CommandDerivative;

impl CandidateLaw for CommandDerivative {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::CommandDerivative)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Actuator
    }

    fn parameters(&self, _facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::strength("time")]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    fn applies(&self, facts: &Scales, _nominal: &Nominal) -> bool {
        facts.input_torque > 0.0
    }
}
