//! Play around the rest position.

use super::{CandidateLaw, EvidenceClass, Parameter, grid, secant};
use crate::data::scales::Scales;
use dynamics::{Effect, Nominal, SystemEffect};

/// Initial half widths, relative to the amplitude.
const PLAY: [f64; 5] = [0.003, 0.01, 0.03, 0.1, 0.3];

/// Half widths of a large play, relative to the amplitude.
const WIDE: [f64; 12] = [0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.26, 0.33, 0.41, 0.5, 0.6, 0.72];

/// Play around the rest position: a half width, within the swing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Backlash;

impl CandidateLaw for Backlash {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::Backlash)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Play
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::strength_up_to("half_width", 0.9 * facts.amplitude)]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    fn applies(&self, _facts: &Scales, nominal: &Nominal) -> bool {
        nominal.stiffness() > 0.0
    }

    fn shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        grid(facts.amplitude, &PLAY, |half_width| vec![half_width])
    }

    fn dense_shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        grid(facts.amplitude, &WIDE, |half_width| vec![half_width])
    }

    fn is_its_own_shape(&self) -> bool {
        true
    }

    /// The shape is the parameter itself; the coefficient of its secant corrects it within limits.
    fn linear_parameters(&self, shape: &[f64], coefficients: &[f64]) -> Vec<f64> {
        secant(shape, coefficients)
    }
}
