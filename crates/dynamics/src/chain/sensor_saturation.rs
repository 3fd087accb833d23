//! Sensor with a limited range.

use super::step::{Extent, Sampled, SampledMotion, Samples, Step};
use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::error::DynamicsError;
use crate::law::Values;
use crate::units::Observed;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "sensor_saturation",
    title: "Sensor saturation",
    kind: Kind::MeasuringChain,
    class: Class::Sensor,
    equation: "x clipped to c ± b",
    latex: r"\min(\max(x,c-b),c+b)",
    parameters: &[
        Parameter {
            name: "bound",
            symbol: "b",
            quantity: Quantity::Observed,
            range: Range::POSITIVE,
            meaning: "distance of the range's ends from its center",
            default: None,
        },
        Parameter {
            name: "center",
            symbol: "c",
            quantity: Quantity::Observed,
            range: Range::ANY,
            meaning: "center of the range",
            default: Some(0.0),
        },
    ],
    tell_tale: "Flat tops at exactly one value, only while the amplitude is large.",
    confused_with: &["end_stop"],
    reference: "Doebelin, Measurement Systems, 5th ed., McGraw-Hill 2004, section 3.2 (span)",
    driven_only: false,
    hidden_states: 0,
    smooth: false,
    example: &[0.5],
};

/// Readings clipped to c ± b. A clipped reading depends on the range alone.
#[derive(Debug, Clone, Copy)]
pub struct SensorSaturation;

impl Step for SensorSaturation {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const DIFFERENTIABLE: bool = true;

    fn transform<S: Sampled>(
        &[bound, center, ..]: &Values<S>,
        _: &SampledMotion<'_, S>,
        _: Observed,
        samples: &mut Samples<S>,
    ) {
        let (lowest, highest) = (center - bound, center + bound);
        for value in &mut samples.values {
            if value.plain() > highest.plain() {
                *value = highest;
            } else if value.plain() < lowest.plain() {
                *value = lowest;
            }
        }
    }

    fn check(&[bound, center, ..]: &Values<f64>, extent: &Extent) -> Result<(), DynamicsError> {
        // If every value lies beyond the same end, the reading never changes.
        let nearest = (extent.smallest - center).max(center - extent.largest);
        if bound > nearest {
            return Ok(());
        }
        Err(DynamicsError::Contradiction {
            effect: DESCRIPTION.id,
            parameter: "bound",
            value: bound,
            relation: "above",
            bound: nearest,
            reason: "the smallest distance of the signal from the range's center: below it every sample is clipped",
        })
    }
}
