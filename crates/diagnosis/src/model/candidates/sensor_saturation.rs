//! A sensor that clips.

use super::{Along, CandidateLaw, EvidenceClass, Parameter, grid};
use crate::data::scales::Scales;
use crate::model::sensor::{Observed, Sensor};
use dynamics::{ChainEffect, Effect};

/// Bounds to begin with, relative to the largest reading.
const CLIPS: [f64; 6] = [0.998, 0.993, 0.98, 0.93, 0.85, 0.7];

/// A sensor that clips, either way at the same value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SensorSaturation;

impl CandidateLaw for SensorSaturation {
    fn effect(&self) -> Effect {
        Effect::MeasuringChain(ChainEffect::SensorSaturation)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Sensor
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::shape("bound", 1e-3 * facts.reading, facts.reading)]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    fn shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        grid(facts.reading, &CLIPS, |bound| vec![bound])
    }

    fn columns(&self, shape: &[f64], along: &Along<'_>) -> Vec<Vec<f64>> {
        let &[bound] = shape else { return Vec::new() };
        vec![along.observed.iter().map(|x| x.clamp(-bound, bound) - x).collect()]
    }

    /// The shape is the parameter itself.
    fn linear_places(&self) -> &'static [usize] {
        &[]
    }

    fn read(&self, values: &[f64], sensor: &mut Sensor) {
        sensor.saturation = values.first().copied();
    }

    fn sensor_derivative(&self, _parameter: usize) -> Option<usize> {
        Some(Observed::BY_BOUND)
    }
}
