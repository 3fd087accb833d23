//! Encoder whose readings lag behind the motion.

use super::{Along, CandidateLaw, EvidenceClass, Parameter};
use crate::data::scales::Scales;
use crate::model::sensor::Sensor;
use dynamics::{Active, ChainEffect, Effect, Nominal};
use record::Quantity;

/// Encoder whose readings lag behind the motion in either direction, by a width of less than two steps.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SensorQuantization;

impl CandidateLaw for SensorQuantization {
    fn effect(&self) -> Effect {
        Effect::MeasuringChain(ChainEffect::SensorQuantization)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Sensor
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::strength_up_to("hysteresis", 2.0 * facts.resolution)]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    /// The sensor's steps show without any fit, so that their hysteresis does not count as an effect.
    fn counts(&self) -> bool {
        false
    }

    fn applies(&self, facts: &Scales, _nominal: &Nominal) -> bool {
        facts.resolution > 0.0
    }

    fn is_observed_in(&self, quantity: Quantity) -> bool {
        quantity == Quantity::Position
    }

    fn resembles(&self) -> &'static [&'static str] {
        &["coulomb_friction", "hysteresis"]
    }

    /// Steps without hysteresis are noise to a fit.
    fn stated(&self, active: &Active) -> Option<Vec<f64>> {
        active.value("hysteresis").filter(|width| *width > 0.0).map(|width| vec![width])
    }

    fn columns(&self, _shape: &[f64], along: &Along<'_>) -> Vec<Vec<f64>> {
        vec![along.rate.iter().map(|rate| if *rate < 0.0 { 1.0 } else { -1.0 }).collect()]
    }

    fn read(&self, values: &[f64], sensor: &mut Sensor) {
        sensor.reading = values.first().copied();
    }

    fn holds_readings(&self) -> bool {
        true
    }

    fn step_parameter(&self) -> Option<&'static str> {
        Some("step")
    }
}
