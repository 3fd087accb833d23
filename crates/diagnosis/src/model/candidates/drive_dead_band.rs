//! Dead band of a servo.

use super::{CandidateLaw, EvidenceClass, Parameter, grid, secant};
use crate::data::scales::Scales;
use dynamics::{Effect, Nominal, SystemEffect};

/// Initial half widths, relative to the drive's largest error.
const WIDTHS: [f64; 4] = [0.005, 0.02, 0.08, 0.25];

/// Half widths of a wide band.
const DENSE_WIDTHS: [f64; 7] = [0.005, 0.015, 0.04, 0.08, 0.15, 0.25, 0.4];

/// Dead band of a servo: a half width, within its largest error.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DriveDeadBand;

impl CandidateLaw for DriveDeadBand {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::DriveDeadBand)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Play
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::strength_up_to("half_width", 0.9 * facts.drive_error)]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    /// Beside damping it lags behind a slow command by its half width, in the direction of motion, as dry friction
    /// does: on a servo's recordings either leaves the same error to a tenth, and friction is the likelier cause. Only a
    /// simulator that has a dead band is calibrated with one.
    fn applies(&self, _facts: &Scales, _nominal: &Nominal) -> bool {
        false
    }

    fn shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        grid(facts.drive_error, &WIDTHS, |half_width| vec![half_width])
    }

    fn dense_shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        grid(facts.drive_error, &DENSE_WIDTHS, |half_width| vec![half_width])
    }

    fn is_its_own_shape(&self) -> bool {
        true
    }

    /// The shape is the parameter itself; the coefficient of its secant corrects it within limits.
    fn linear_parameters(&self, shape: &[f64], coefficients: &[f64]) -> Vec<f64> {
        secant(shape, coefficients)
    }
}
