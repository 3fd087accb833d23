//! Sensor with an error that repeats once a turn.

use super::{Along, CandidateLaw, EvidenceClass, Parameter, Polar};
use crate::data::scales::Scales;
use crate::model::sensor::{Observed, Sensor};
use dynamics::{ChainEffect, Coordinate, Effect, Nominal};
use record::Quantity;

const POLAR: Polar = Polar { size: 0, angle: 1 };

/// Sensor with an error that repeats once a turn: amplitude and phase, fitted as a Cartesian pair.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SensorNonlinearity;

impl CandidateLaw for SensorNonlinearity {
    fn effect(&self) -> Effect {
        Effect::MeasuringChain(ChainEffect::SensorNonlinearity)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Sensor
    }

    fn parameters(&self, _facts: &Scales) -> Vec<Parameter> {
        vec![Parameter::any("amplitude"), Parameter::any("phase")]
    }

    fn is_non_negative(&self) -> bool {
        false
    }

    /// The error is a sine of the coordinate, which must therefore be an angle.
    fn applies(&self, _facts: &Scales, nominal: &Nominal) -> bool {
        nominal.coordinate() == Coordinate::Angle
    }

    fn is_observed_in(&self, quantity: Quantity) -> bool {
        quantity == Quantity::Position
    }

    fn resembles(&self) -> &'static [&'static str] {
        &["asymmetric_stiffness", "gravity", "cubic_stiffness"]
    }

    /// The amplitude adds to the observed quantity and is compared with its size.
    fn quantity(&self, index: usize) -> dynamics::Quantity {
        if index == 1 { dynamics::Quantity::Angle } else { dynamics::Quantity::Observed }
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

    fn shapes(&self, _facts: &Scales) -> Vec<Vec<f64>> {
        vec![vec![1.0, 0.0]]
    }

    fn linear_places(&self) -> &'static [usize] {
        &[0, 1]
    }

    fn columns(&self, _shape: &[f64], along: &Along<'_>) -> Vec<Vec<f64>> {
        let x = along.observed;
        vec![x.iter().map(|x| libm::sin(*x)).collect(), x.iter().map(|x| libm::cos(*x)).collect()]
    }

    fn read(&self, values: &[f64], sensor: &mut Sensor) {
        if let &[amplitude, phase] = values {
            sensor.nonlinearity = Some((amplitude, phase));
        }
    }

    fn sensor_derivative(&self, parameter: usize) -> Option<usize> {
        [Observed::BY_AMPLITUDE, Observed::BY_PHASE].get(parameter).copied()
    }
}
