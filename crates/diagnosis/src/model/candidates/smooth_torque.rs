//! A smooth torque without a name.

use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, SystemEffect};

/// A smooth torque of higher order without a name: drag of another power, a damping that grows or falls with the deflection, a
/// spring that bends otherwise than by the cube. It is no candidate for a name, and what could stand in the place of some
/// (see [`crate::search::nameless`]).
#[derive(Debug, Clone, Copy)]
pub(crate) struct SmoothTorque;

impl CandidateLaw for SmoothTorque {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::SmoothTorque)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Unnamed
    }

    fn stands_for(&self) -> &'static [EvidenceClass] {
        &[EvidenceClass::Damping, EvidenceClass::Restoring]
    }

    fn parameters(&self, _facts: &Scales) -> Vec<Parameter> {
        let names = ["cubic_damping", "deflection_damping", "quintic_stiffness"];
        names.map(Parameter::any).to_vec()
    }

    fn is_non_negative(&self) -> bool {
        false
    }

    fn linear_places(&self) -> &'static [usize] {
        &[0, 1, 2]
    }
}
