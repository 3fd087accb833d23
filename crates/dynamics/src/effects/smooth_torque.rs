//! A smooth torque without a name: of higher order than the laws of the vocabulary.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "smooth_torque",
    title: "Smooth torque without a name",
    kind: Kind::System,
    class: Class::Dissipative,
    equation: "-(a θ̇³ + b (θ - θ_rest)² θ̇ + k_5 (θ - θ_rest)⁵)",
    latex: r"-\left(a\,\dot\theta^3+b\,(\theta-\theta_\mathrm{rest})^2\,\dot\theta+k_5\,(\theta-\theta_\mathrm{rest})^5\right)",
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
        Parameter {
            name: "quintic_stiffness",
            symbol: "k_5",
            quantity: Quantity::QuinticStiffness,
            range: Range::ANY,
            meaning: "torque per deflection to the fifth power",
            default: None,
        },
    ],
    tell_tale: "The decay rate changes as A², the frequency as A⁴.",
    confused_with: &[],
    reference: "Nayfeh, Mook, Nonlinear Oscillations, Wiley 1979, section 3.3",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
};

/// A smooth torque without a name: −(a·θ̇³ + b·(θ − θ_rest)²·θ̇ + k₅·(θ − θ_rest)⁵).
///
/// It is no effect of the vocabulary, and stands for smooth laws that are none either: drag of another power, a damping that
/// grows or falls with the deflection, a spring that bends otherwise than by the cube.
#[derive(Debug, Clone, Copy)]
pub struct SmoothTorque;

impl Law for SmoothTorque {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque(
        "-({cubic_damping} * velocity * velocity * velocity \
         + {deflection_damping} * (position - rest_angle) * (position - rest_angle) * velocity \
         + {quintic_stiffness} * (position - rest_angle) * (position - rest_angle) * (position - rest_angle) \
         * (position - rest_angle) * (position - rest_angle))",
    );

    fn torque<S: Scalar>(&[cubic, deflected, quintic, _]: &Values<S>, moment: &Moment<S>) -> S {
        let deflection = moment.position - moment.nominal.rest_angle;
        let (square, velocity) = (deflection * deflection, moment.velocity);
        -(cubic * velocity * velocity * velocity
            + deflected * square * velocity
            + quintic * square * square * deflection)
    }
}
