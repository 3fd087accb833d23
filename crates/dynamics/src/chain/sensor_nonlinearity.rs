//! Eccentric encoder.

use super::step::{Extent, Sampled, SampledMotion, Samples, Step};
use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::error::DynamicsError;
use crate::law::Values;
use crate::units::Observed;
use crate::units::{Coordinate, Quantity};

const DESCRIPTION: Description = Description {
    id: "sensor_nonlinearity",
    title: "Sensor nonlinearity",
    kind: Kind::MeasuringChain,
    class: Class::Sensor,
    equation: "x + a sin(x + φ)",
    latex: r"x+a\,\sin(x+\varphi)",
    parameters: &[
        Parameter {
            name: "amplitude",
            symbol: "a",
            quantity: Quantity::Angle,
            // Beyond 1 rad the reading would no longer rise with the angle everywhere.
            range: Range { minimum: 0.0, maximum: 1.0, closed: true },
            meaning: "largest error: the eccentricity over the radius of the encoder's track",
            default: None,
        },
        Parameter {
            name: "phase",
            symbol: "φ",
            quantity: Quantity::Angle,
            range: Range::TURN,
            meaning: "direction of the eccentricity at x = 0",
            default: None,
        },
    ],
    tell_tale: "Harmonics and a mean that moves with A², as from a nonlinear spring; but they depend only on \
                the position, not on speed or acceleration.",
    confused_with: &["asymmetric_stiffness", "cubic_stiffness", "gravity"],
    reference: "de Silva, Sensors and Actuators, 2nd ed., CRC Press 2015 (eccentricity error of encoders)",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[0.02, 0.4],
};

/// Eccentrically mounted encoder disk or magnet: x + a·sin(x + φ).
#[derive(Debug, Clone, Copy)]
pub struct SensorNonlinearity;

impl Step for SensorNonlinearity {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const DIFFERENTIABLE: bool = true;

    fn transform<S: Sampled>(
        &[amplitude, phase, ..]: &Values<S>,
        _: &SampledMotion<'_, S>,
        _: Observed,
        samples: &mut Samples<S>,
    ) {
        for value in &mut samples.values {
            *value = *value + amplitude * (*value + phase).sin();
        }
    }

    fn check(_: &Values<f64>, extent: &Extent) -> Result<(), DynamicsError> {
        if extent.observed == Observed::Position && extent.coordinate == Coordinate::Angle {
            return Ok(());
        }
        Err(DynamicsError::NotForThisSensor {
            effect: DESCRIPTION.id,
            needs: "an encoder: quantity \"position\" of coordinate \"angle\"",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::SensorNonlinearity;
    use crate::chain::{Observed, SampledMotion, Samples, Step};
    use crate::scalar::Dual;

    #[test]
    fn reading_and_derivatives_are_those_of_the_formula() {
        let (x, a, phase) = (0.4_f64, 0.02, 1.1);
        let variable = Dual::<3>::variable;
        let mut samples =
            Samples { indices: vec![0], times_s: vec![0.0], values: vec![variable(x, 0)], stamps_s: vec![] };
        let motion = SampledMotion { times_s: &[0.0], position: &[], velocity: &[], acceleration: &[] };
        let zero = Dual::from(0.0);
        let values = [variable(a, 1), variable(phase, 2), zero, zero];
        SensorNonlinearity::transform(&values, &motion, Observed::Position, &mut samples);
        let found = samples.values[0];
        assert_eq!(found.value, x + a * (x + phase).sin());
        let cosine = (x + phase).cos();
        assert_eq!(found.partials, [1.0 + a * cosine, (x + phase).sin(), a * cosine]);
    }
}
