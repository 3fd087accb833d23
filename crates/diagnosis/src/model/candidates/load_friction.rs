//! Friction that grows with the load of a servo's drive.

use super::coulomb_friction::CoulombFriction;
use super::{CandidateLaw, EvidenceClass, Parameter, has_drive};
use crate::data::scales::Scales;
use dynamics::{Effect, Nominal, SystemEffect};

/// Coefficient at which a fit begins that was one of Coulomb friction.
const COEFFICIENT: f64 = 0.1;

/// Friction that grows with the load: the torque without load, and the coefficient of the drive's torque.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LoadFriction;

impl CandidateLaw for LoadFriction {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::LoadFriction)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Friction
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        let torque = if facts.friction_known { 0.0 } else { f64::INFINITY };
        vec![Parameter::within("torque", 0.0, torque), Parameter::strength("coefficient")]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    fn applies(&self, facts: &Scales, nominal: &Nominal) -> bool {
        has_drive(facts, nominal)
    }

    /// Without its coefficient it is Coulomb friction.
    fn generalizes(&self) -> Option<&'static dyn CandidateLaw> {
        Some(&CoulombFriction)
    }

    fn shapes(&self, _facts: &Scales) -> Vec<Vec<f64>> {
        vec![vec![1.0, COEFFICIENT]]
    }

    /// The columns are those of the torque without load and of the coefficient. If the nominal simulator has Coulomb
    /// friction, its torque is not fitted twice.
    fn unit_values(&self, _shape: &[f64], facts: &Scales) -> Vec<Vec<f64>> {
        let both = [vec![1.0, 0.0], vec![0.0, 1.0]];
        both.into_iter().skip(usize::from(facts.friction_known)).collect()
    }

    /// Without a column of its own the torque without load is 0.
    fn linear_parameters(&self, _shape: &[f64], coefficients: &[f64]) -> Vec<f64> {
        match *coefficients {
            [torque, coefficient] => vec![torque, coefficient],
            [coefficient] => vec![0.0, coefficient],
            _ => Vec::new(),
        }
    }
}
