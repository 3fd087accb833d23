//! Elastic stop at one end of the swing.

use super::{CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, SystemEffect};

/// Initial positions: distances from either end of the swing, relative to its span.
const STOPS: [f64; 5] = [0.004, 0.015, 0.05, 0.12, 0.25];

/// Positions of a stop that is met on every swing.
const FAR_STOPS: [f64; 14] =
    [0.003, 0.01, 0.02, 0.035, 0.055, 0.08, 0.11, 0.145, 0.185, 0.23, 0.28, 0.34, 0.4, 0.46];

/// Elastic stop at one end of the swing: its position, its stiffness and its dissipation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EndStop;

impl CandidateLaw for EndStop {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::EndStop)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Play
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        vec![
            Parameter::shape("angle", facts.lowest, facts.highest),
            Parameter::strength_up_to("stiffness", 1e5 * facts.stiffness),
            Parameter::within("dissipation", 0.0, f64::INFINITY),
        ]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    fn is_flexible(&self) -> bool {
        true
    }

    fn shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        at(&STOPS, facts)
    }

    fn dense_shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        at(&FAR_STOPS, facts)
    }

    fn linear_places(&self) -> &'static [usize] {
        &[1]
    }
}

/// Returns the shapes of stops at both ends, at distances from there relative to the swing's span.
fn at(parts: &[f64], facts: &Scales) -> Vec<Vec<f64>> {
    let span = facts.highest - facts.lowest;
    let upper = parts.iter().map(|part| facts.highest - part * span);
    let lower = parts.iter().map(|part| facts.lowest + part * span);
    upper.chain(lower).map(|angle| vec![angle, 1.0, 0.0]).collect()
}
