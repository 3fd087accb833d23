//! Sensor that clips.

use super::{Along, CandidateLaw, EvidenceClass, Parameter, grid};
use crate::data::scales::Scales;
use crate::model::sensor::{Observed, Sensor};
use dynamics::{ChainEffect, Effect};

/// Initial half ranges about the middle of the readings, relative to half of their span.
const CLIPS: [f64; 6] = [0.998, 0.993, 0.98, 0.93, 0.85, 0.7];

/// Sensor that clips at both ends of its range, whose center need not be zero.
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
        vec![Parameter::shape("bound", 1e-3 * facts.reading, facts.reading), Parameter::any("center")]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    fn shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        // Readings that are positions are in their own unit already.
        let largest = facts.highest.abs().max(facts.lowest.abs()).max(f64::MIN_POSITIVE);
        let unit = facts.reading / largest;
        let (half, middle) = (0.5 * (facts.highest - facts.lowest), 0.5 * (facts.highest + facts.lowest));
        grid(unit * half, &CLIPS, |bound| vec![bound, unit * middle])
    }

    fn columns(&self, shape: &[f64], along: &Along<'_>) -> Vec<Vec<f64>> {
        let &[bound, center] = shape else { return Vec::new() };
        let clipped = |x: &f64| x.clamp(center - bound, center + bound) - x;
        vec![along.observed.iter().map(clipped).collect()]
    }

    /// The shape is the parameter itself.
    fn linear_places(&self) -> &'static [usize] {
        &[]
    }

    fn read(&self, values: &[f64], sensor: &mut Sensor) {
        sensor.saturation = values.first().copied().zip(values.get(1).copied());
    }

    fn sensor_derivative(&self, parameter: usize) -> Option<usize> {
        [Observed::BY_BOUND, Observed::BY_CENTER].get(parameter).copied()
    }
}
