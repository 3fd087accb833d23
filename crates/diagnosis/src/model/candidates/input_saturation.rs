//! Input whose torque is limited.

use super::{CandidateLaw, EvidenceClass, Parameter, grid};
use crate::data::scales::Scales;
use dynamics::{Effect, Nominal, SystemEffect};

/// Initial limits, relative to the input's largest torque.
const LIMITS: [f64; 4] = [0.95, 0.85, 0.7, 0.5];

/// Input whose torque is limited.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InputSaturation;

impl CandidateLaw for InputSaturation {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::InputSaturation)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Actuator
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::shape("torque", 1e-3 * facts.input_torque, facts.input_torque)]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    fn applies(&self, facts: &Scales, _nominal: &Nominal) -> bool {
        facts.input_torque > 0.0
    }

    fn shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        grid(facts.input_torque, &LIMITS, |torque| vec![torque])
    }

    /// The shape is the parameter itself.
    fn linear_places(&self) -> &'static [usize] {
        &[]
    }
}
