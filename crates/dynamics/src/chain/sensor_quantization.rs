//! A sensor with a step.

use super::step::{Extent, Samples, Step};
use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::error::DynamicsError;
use crate::law::Values;
use crate::units::Quantity;
use rand::Rng;

const DESCRIPTION: Description = Description {
    id: "sensor_quantization",
    title: "Sensor quantization",
    kind: Kind::MeasuringChain,
    class: Class::Sensor,
    equation: "q round(x/q)",
    latex: r"q\,\operatorname{round}(x/q)",
    parameters: &[Parameter {
        name: "step",
        symbol: "q",
        quantity: Quantity::Observed,
        range: Range::POSITIVE,
        meaning: "distance between neighboring readings",
    }],
    tell_tale: "Few distinct values; the residual stays within half a step, and is uniform there while the motion is large.",
    confused_with: &["coulomb_friction"],
    reference: "Widrow, Kollár, Quantization Noise, Cambridge 2008, chapter 3",
    driven_only: false,
    hidden_states: 0,
    smooth: false,
};

/// Readings rounded to whole multiples of a step.
#[derive(Debug, Clone, Copy)]
pub struct SensorQuantization;

impl Step for SensorQuantization {
    const DESCRIPTION: &'static Description = &DESCRIPTION;

    fn distort<R: Rng + ?Sized>(&[step, ..]: &Values<f64>, samples: &mut Samples<f64>, _: &mut R) {
        for value in &mut samples.values {
            *value = step * (*value / step).round();
        }
    }

    fn check(&[step, ..]: &Values<f64>, extent: &Extent) -> Result<(), DynamicsError> {
        let span = extent.largest - extent.smallest;
        if step <= span {
            return Ok(());
        }
        Err(DynamicsError::Contradiction {
            effect: DESCRIPTION.id,
            parameter: "step",
            value: step,
            relation: "at most",
            bound: span,
            reason: "the span of the signal: a coarser sensor does not see the motion",
        })
    }
}
