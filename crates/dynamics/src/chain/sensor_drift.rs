//! Drifting zero of a sensor.

use super::step::{Sampled, SampledMotion, Samples, Step};
use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::law::Values;
use crate::units::Observed;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "sensor_drift",
    title: "Sensor drift",
    kind: Kind::MeasuringChain,
    class: Class::Sensor,
    equation: "x + d (t - t₀)",
    latex: r"x+d\,(t-t_0)",
    parameters: &[Parameter {
        name: "rate",
        symbol: "d",
        quantity: Quantity::ObservedPerTime,
        range: Range::ANY,
        meaning: "change of the sensor's zero per second",
        default: None,
    }],
    tell_tale: "The mean moves with time, not with amplitude, and continues to move after the motion has \
                ended.",
    confused_with: &["constant_torque"],
    reference: "Doebelin, Measurement Systems, 5th ed., McGraw-Hill 2004, section 3.2 (zero drift)",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[0.01],
};

/// Linear baseline: x + d·(t − t₀), where t₀ is the first sample's time.
#[derive(Debug, Clone, Copy)]
pub struct SensorDrift;

impl Step for SensorDrift {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const DIFFERENTIABLE: bool = true;

    fn transform<S: Sampled>(
        &[rate, ..]: &Values<S>,
        _: &SampledMotion<'_, S>,
        _: Observed,
        samples: &mut Samples<S>,
    ) {
        let Some(&start) = samples.times_s.first() else { return };
        for (value, time) in samples.values.iter_mut().zip(&samples.times_s) {
            *value = *value + rate * (time - start);
        }
    }
}
