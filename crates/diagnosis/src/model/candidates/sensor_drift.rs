//! Sensor whose zero drifts.

use super::{Along, CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use crate::model::sensor::{Observed, Sensor};
use dynamics::{ChainEffect, Effect, Nominal};

/// Sensor whose zero drifts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SensorDrift;

impl CandidateLaw for SensorDrift {
    fn effect(&self) -> Effect {
        Effect::MeasuringChain(ChainEffect::SensorDrift)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Sensor
    }

    fn parameters(&self, _facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::any("rate")]
    }

    fn is_non_negative(&self) -> bool {
        false
    }

    /// Without a spring nothing brings the body back to where the sensor should read zero.
    fn applies(&self, _facts: &Scales, nominal: &Nominal) -> bool {
        nominal.stiffness() > 0.0
    }

    fn resembles(&self) -> &'static [&'static str] {
        &["stiffness_drift"]
    }

    fn columns(&self, _shape: &[f64], along: &Along<'_>) -> Vec<Vec<f64>> {
        vec![along.times.to_vec()]
    }

    fn read(&self, values: &[f64], sensor: &mut Sensor) {
        sensor.drift = values.first().copied();
    }

    fn sensor_derivative(&self, _parameter: usize) -> Option<usize> {
        Some(Observed::BY_DRIFT)
    }
}
