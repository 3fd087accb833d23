//! Damping without a name, of higher order than the laws of the vocabulary.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "unlisted_damping",
    title: "Damping without a name",
    kind: Kind::System,
    class: Class::Dissipative,
    equation: "-(a θ̇³ + b (θ - θ_rest)² θ̇)",
    latex: r"-\left(a\,\dot\theta^3+b\,(\theta-\theta_\mathrm{rest})^2\,\dot\theta\right)",
    parameters: &[
        Parameter {
            name: "cubic_damping",
            symbol: "a",
            quantity: Quantity::CubicDamping,
            range: Range::ANY,
            meaning: "torque per velocity cubed",
            default: None,
        },
        Parameter {
            name: "deflection_damping",
            symbol: "b",
            quantity: Quantity::DeflectionDamping,
            range: Range::ANY,
            meaning: "damping per deflection squared",
            default: None,
        },
    ],
    tell_tale: "The decay rate changes as A².",
    confused_with: &[],
    reference: "Nayfeh, Mook, Nonlinear Oscillations, Wiley 1979, section 3.3",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[0.02, 10.0],
};

/// Damping without a name: −(a·θ̇³ + b·(θ − θ_rest)²·θ̇).
///
/// It is not an effect of the vocabulary, and represents dampings outside it: drag of another power, or a
/// damping that grows or falls with the deflection.
#[derive(Debug, Clone, Copy)]
pub struct UnlistedDamping;

impl Law for UnlistedDamping {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque(
        "-({cubic_damping} * velocity * velocity * velocity \
         + {deflection_damping} * (position - rest_angle) * (position - rest_angle) * velocity)",
    );

    fn torque<S: Scalar>(&[cubic, deflected, ..]: &Values<S>, moment: &Moment<S>) -> S {
        let deflection = moment.position - moment.nominal.rest_angle;
        let velocity = moment.velocity;
        -(cubic * velocity * velocity * velocity + deflected * deflection * deflection * velocity)
    }
}
