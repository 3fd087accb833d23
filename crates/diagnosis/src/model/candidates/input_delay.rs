//! Input that acts late.

use super::{Along, CandidateLaw, EvidenceClass, Parameter, grid, secant};
use crate::data::scales::Scales;
use dynamics::{Effect, Nominal, SystemEffect};

/// Initial delays, relative to the time of a radian of the swing.
const DELAYS: [f64; 2] = [0.01, 0.1];

/// Input that acts late, by less than the time of a radian of the swing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InputDelay;

impl CandidateLaw for InputDelay {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::InputDelay)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Actuator
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::strength_up_to("delay", 1.0 / facts.frequency)]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    fn applies(&self, facts: &Scales, _nominal: &Nominal) -> bool {
        facts.input_torque > 0.0
    }

    fn shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        grid(1.0 / facts.frequency, &DELAYS, |delay| vec![delay])
    }

    /// The column is the response to the difference between the delayed and the present torque.
    fn columns(&self, shape: &[f64], along: &Along<'_>) -> Vec<Vec<f64>> {
        let &[delay] = shape else { return Vec::new() };
        let shift = |input: &dynamics::Input| {
            let samples = along.times.iter().zip(along.input);
            samples.map(|(time, now)| along.nominal.input_gain * input.at(time - delay) - now).collect()
        };
        let shifted: Vec<f64> = along.command.map_or_else(|| vec![0.0; along.times.len()], shift);
        vec![(along.respond)(&shifted)]
    }

    fn is_its_own_shape(&self) -> bool {
        true
    }

    /// The shape is the parameter itself; the coefficient of its secant corrects it within limits.
    fn linear_parameters(&self, shape: &[f64], coefficients: &[f64]) -> Vec<f64> {
        secant(shape, coefficients)
    }
}
