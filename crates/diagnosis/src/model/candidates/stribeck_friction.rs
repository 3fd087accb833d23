//! Friction that falls with speed.

use super::coulomb_friction::CoulombFriction;
use super::{CandidateLaw, EvidenceClass, Parameter, grid};
use crate::data::scales::Scales;
use dynamics::{Effect, SystemEffect};

/// Initial Stribeck velocities, relative to the largest speed.
const SPEEDS: [f64; 3] = [0.02, 0.06, 0.2];

/// Speeds at which a large excess is looked for.
const DENSE_SPEEDS: [f64; 6] = [0.03, 0.06, 0.1, 0.17, 0.27, 0.4];

/// Friction that falls with speed: Coulomb's torque, the excess of the static torque over it (so that the
/// static torque is at least Coulomb's), and the velocity over which the excess is lost.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StribeckFriction;

impl CandidateLaw for StribeckFriction {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::StribeckFriction)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Friction
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        let torque = if facts.friction_known { 0.0 } else { f64::INFINITY };
        vec![
            Parameter::within("torque", 0.0, torque),
            Parameter::strength("static_torque"),
            Parameter::simplifying_shape("velocity", 1e-3 * facts.speed, 0.5 * facts.speed),
        ]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    /// Without its excess it is Coulomb friction.
    fn generalizes(&self) -> Option<&'static dyn CandidateLaw> {
        Some(&CoulombFriction)
    }

    fn values(&self, fitted: &[f64]) -> Vec<f64> {
        let mut values = fitted.to_vec();
        if let [torque, excess, _] = values.as_mut_slice() {
            *excess += *torque;
        }
        values
    }

    fn fitted(&self, values: &[f64]) -> Vec<f64> {
        let mut fitted = values.to_vec();
        if let [torque, excess, _] = fitted.as_mut_slice() {
            *excess -= *torque;
        }
        fitted
    }

    fn slopes(&self, _fitted: &[f64]) -> Vec<(usize, usize, f64)> {
        vec![(1, 0, 1.0)]
    }

    fn shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        grid(facts.speed, &SPEEDS, |velocity| vec![1.0, 1.0, velocity])
    }

    fn dense_shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        grid(facts.speed, &DENSE_SPEEDS, |velocity| vec![1.0, 1.0, velocity])
    }

    /// The columns are those of Coulomb's torque and of the excess. If the nominal simulator has Coulomb
    /// friction, its torque is not fitted twice.
    fn unit_values(&self, shape: &[f64], facts: &Scales) -> Vec<Vec<f64>> {
        let &[_, _, velocity] = shape else { return Vec::new() };
        let both = [vec![1.0, 1.0, velocity], vec![0.0, 1.0, velocity]];
        both.into_iter().skip(usize::from(facts.friction_known)).collect()
    }

    /// Without a column of its own Coulomb's torque is 0.
    fn linear_parameters(&self, shape: &[f64], coefficients: &[f64]) -> Vec<f64> {
        let (torque, excess) = match *coefficients {
            [torque, excess] => (torque, excess),
            [excess] => (0.0, excess),
            _ => return Vec::new(),
        };
        [torque, excess].into_iter().chain(shape.iter().skip(2).copied()).collect()
    }
}
