//! Friction that drifts.

use super::coulomb_friction::CoulombFriction;
use super::{CandidateLaw, EvidenceClass, Parameter, grid, has_drive};
use crate::data::scales::Scales;
use dynamics::{Effect, Nominal, SystemEffect};

/// Initial rates, relative to the inverse of the record's length, and the largest one.
const RATES: [f64; 2] = [-2.5, 1.5];
const FASTEST: f64 = 30.0;

/// Friction that drifts: its torque at time 0 and the relative rate of change.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrictionDrift;

impl CandidateLaw for FrictionDrift {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::FrictionDrift)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Friction
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        let fastest = FASTEST / facts.duration;
        vec![Parameter::strength("torque"), Parameter::shape("rate", -fastest, fastest)]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    fn applies(&self, facts: &Scales, nominal: &Nominal) -> bool {
        has_drive(facts, nominal)
    }

    /// At a rate of 0 it is Coulomb friction.
    fn generalizes(&self) -> Option<&'static dyn CandidateLaw> {
        Some(&CoulombFriction)
    }

    fn shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        grid(1.0 / facts.duration, &RATES, |rate| vec![1.0, rate])
    }
}
