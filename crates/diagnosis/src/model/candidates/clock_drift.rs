//! Clock whose rate changes.

use super::{Along, CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use crate::model::sensor::{Observed, Sensor};
use dynamics::{Active, ChainEffect, Effect};
use record::Quantity;

/// Clock whose rate changes, by less than half over the longest record.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ClockDrift;

impl CandidateLaw for ClockDrift {
    fn effect(&self) -> Effect {
        Effect::MeasuringChain(ChainEffect::ClockDrift)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Drift
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::within("change", -0.4 / facts.duration, 0.4 / facts.duration)]
    }

    fn is_non_negative(&self) -> bool {
        false
    }

    fn is_flexible(&self) -> bool {
        true
    }

    /// The effect acts by the time derivative of the observed quantity, which is not available for
    /// accelerations.
    fn is_observed_in(&self, quantity: Quantity) -> bool {
        quantity != Quantity::Acceleration
    }

    fn resembles(&self) -> &'static [&'static str] {
        &["stiffness_drift", "cubic_stiffness"]
    }

    fn quantity(&self, _index: usize) -> dynamics::Quantity {
        dynamics::Quantity::Rate
    }

    /// A rate that is off by a constant factor is part of the calibration.
    fn stated(&self, active: &Active) -> Option<Vec<f64>> {
        active.value("change").map(|change| vec![change])
    }

    fn columns(&self, _shape: &[f64], along: &Along<'_>) -> Vec<Vec<f64>> {
        vec![along.rate.iter().zip(along.times).map(|(rate, t)| -0.5 * t * t * rate).collect()]
    }

    fn read(&self, values: &[f64], sensor: &mut Sensor) {
        sensor.clock = values.first().copied();
    }

    fn sensor_derivative(&self, _parameter: usize) -> Option<usize> {
        Some(Observed::BY_CLOCK)
    }
}
