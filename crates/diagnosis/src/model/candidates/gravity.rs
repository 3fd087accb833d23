//! Weight of an unbalanced arm.

use super::{CandidateLaw, EvidenceClass, Parameter, Polar};
use crate::data::scales::Scales;
use dynamics::{Coordinate, Effect, Nominal, SystemEffect};
use std::f64::consts::FRAC_PI_2;

const POLAR: Polar = Polar { size: 0, angle: 1 };

/// Weight of an unbalanced arm: torque and angle, fitted as a Cartesian pair.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gravity;

impl CandidateLaw for Gravity {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::Gravity)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Restoring
    }

    fn is_plain(&self) -> bool {
        true
    }

    fn parameters(&self, _facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::any("torque"), Parameter::any("angle")]
    }

    fn is_non_negative(&self) -> bool {
        false
    }

    /// The torque is a sine of the coordinate, which must therefore be an angle.
    fn applies(&self, _facts: &Scales, nominal: &Nominal) -> bool {
        nominal.coordinate() == Coordinate::Angle
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

    fn is_weight(&self) -> bool {
        true
    }

    fn shapes(&self, _facts: &Scales) -> Vec<Vec<f64>> {
        vec![vec![1.0, 0.0]]
    }

    fn linear_places(&self) -> &'static [usize] {
        &[0, 1]
    }

    fn unit_values(&self, _shape: &[f64], _facts: &Scales) -> Vec<Vec<f64>> {
        vec![vec![1.0, 0.0], vec![1.0, FRAC_PI_2]]
    }
}
