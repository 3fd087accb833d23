//! Torque that repeats along the position, without a name.

use super::{CandidateLaw, EvidenceClass, Parameter, Polar};
use crate::data::scales::Scales;
use dynamics::{Effect, SystemEffect};

const POLAR: Polar = Polar { size: 0, angle: 2 };

/// Torque that repeats along the position, as from magnets, bearings and screws. It has no name in the
/// vocabulary; the search for it runs after names are given (see [`crate::explain::position_torque`]).
#[derive(Debug, Clone, Copy)]
pub(crate) struct PositionTorque;

impl CandidateLaw for PositionTorque {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::PositionTorque)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Unnamed
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        let [lowest, highest] = facts.waves();
        vec![
            Parameter::any("torque"),
            Parameter::simplifying_shape("wavenumber", lowest, highest),
            Parameter::any("phase"),
        ]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    fn is_flexible(&self) -> bool {
        true
    }

    fn values(&self, fitted: &[f64]) -> Vec<f64> {
        POLAR.values(fitted)
    }

    fn fitted(&self, values: &[f64]) -> Vec<f64> {
        POLAR.fitted(values)
    }

    fn slopes(&self, fitted: &[f64]) -> Vec<(usize, usize, f64)> {
        POLAR.slopes(fitted)
    }
}
