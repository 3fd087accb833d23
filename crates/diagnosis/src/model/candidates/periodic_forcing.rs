//! Torque that repeats in time.

use super::{CandidateLaw, EvidenceClass, Lines, MainMode, Parameter, Polar};
use crate::data::scales::Scales;
use dynamics::{Effect, SystemEffect};
use std::f64::consts::{FRAC_PI_2, PI};

const POLAR: Polar = Polar { size: 0, angle: 2 };

/// Number of lines of the residual at which the effect is tried.
const LINES: usize = 3;

/// Torque that repeats in time: torque and phase, fitted as a Cartesian pair, and frequency.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PeriodicForcing;

impl CandidateLaw for PeriodicForcing {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::PeriodicForcing)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Forcing
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        vec![
            Parameter::any("torque"),
            // A forcing that does not repeat within the records is a drift.
            Parameter::shape("frequency", 4.0 * PI / facts.duration, PI / facts.interval),
            Parameter::any("phase"),
        ]
    }

    fn is_non_negative(&self) -> bool {
        false
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

    /// The frequencies come from the residual.
    fn shapes(&self, _facts: &Scales) -> Vec<Vec<f64>> {
        Vec::new()
    }

    fn shapes_for(&self, _facts: &Scales, residual: &dyn Lines) -> Vec<Vec<f64>> {
        residual.steady(LINES).into_iter().map(|frequency| vec![1.0, frequency, 0.0]).collect()
    }

    /// Everything that depends on a repeating motion has lines at multiples of its frequency. A forcing there
    /// cannot be told from any law that the model lacks, nor one at a line of the input from an error of the
    /// input's own path.
    fn is_itself(&self, fitted: &[f64], swing: &MainMode<'_>) -> bool {
        fitted.get(1).is_none_or(|frequency| {
            !swing.repeats.is_some_and(|own| own.has(*frequency)) && !swing.is_of_input(*frequency)
        })
    }

    fn is_chosen_by_frequency(&self) -> bool {
        true
    }

    fn unit_values(&self, shape: &[f64], _facts: &Scales) -> Vec<Vec<f64>> {
        let &[_, frequency, _] = shape else { return Vec::new() };
        vec![vec![1.0, frequency, 0.0], vec![1.0, frequency, FRAC_PI_2]]
    }

    fn linear_places(&self) -> &'static [usize] {
        &[0, 2]
    }
}
