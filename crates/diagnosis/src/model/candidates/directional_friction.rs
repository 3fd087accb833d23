//! Friction that differs by direction.
//!
//! It is Coulomb friction beside a constant torque, in every state, and the constant torque shifts the rest angle,
//! which is part of the calibration. No record tells it from these two, so that it is no candidate for a name:
//! friction is then answered as Coulomb's. Only a nominal simulator may have it.

use super::coulomb_friction::CoulombFriction;
use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, Nominal, SystemEffect};

/// Friction that differs by direction, of a nominal simulator.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DirectionalFriction;

impl CandidateLaw for DirectionalFriction {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::DirectionalFriction)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Friction
    }

    fn parameters(&self, _facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::strength("torque"), Parameter::any("difference")]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    /// Nothing tells it from Coulomb friction and a shifted rest angle.
    fn applies(&self, _facts: &Scales, _nominal: &Nominal) -> bool {
        false
    }

    /// Without its difference it is Coulomb friction.
    fn generalizes(&self) -> Option<&'static dyn CandidateLaw> {
        Some(&CoulombFriction)
    }

    fn shapes(&self, _facts: &Scales) -> Vec<Vec<f64>> {
        vec![vec![1.0, 0.0]]
    }
}
