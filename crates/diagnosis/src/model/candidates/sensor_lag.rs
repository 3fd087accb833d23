//! Sensor that follows with a lag.

use super::{Along, CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use crate::model::sensor::{Observed, Sensor};
use dynamics::{ChainEffect, Effect, Nominal};
use record::Quantity;

/// Sensor that follows with a lag: a time constant, less than the time of half a radian of the swing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SensorLag;

impl CandidateLaw for SensorLag {
    fn effect(&self) -> Effect {
        Effect::MeasuringChain(ChainEffect::SensorLag)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Sensor
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::strength_up_to("time_constant", 0.5 / facts.frequency)]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    /// At a single frequency a lag is a change of amplitude and phase, which the start state absorbs.
    fn applies(&self, facts: &Scales, _nominal: &Nominal) -> bool {
        facts.input_torque > 0.0
    }

    /// The effect acts by the time derivative of the observed quantity, which is not available for
    /// accelerations.
    fn is_observed_in(&self, quantity: Quantity) -> bool {
        quantity != Quantity::Acceleration
    }

    fn columns(&self, _shape: &[f64], along: &Along<'_>) -> Vec<Vec<f64>> {
        vec![along.rate.iter().map(|rate| -rate).collect()]
    }

    fn read(&self, values: &[f64], sensor: &mut Sensor) {
        sensor.lag = values.first().copied();
    }

    fn sensor_derivative(&self, _parameter: usize) -> Option<usize> {
        Some(Observed::BY_LAG)
    }
}
