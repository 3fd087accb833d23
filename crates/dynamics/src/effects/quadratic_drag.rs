//! Drag of a turbulent wake.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "quadratic_drag",
    title: "Quadratic drag",
    kind: Kind::System,
    class: Class::Dissipative,
    equation: "-β θ′ |θ′|",
    latex: r"-\beta\,\dot\theta\,\lvert\dot\theta\rvert",
    parameters: &[Parameter {
        name: "coefficient",
        symbol: "β",
        quantity: Quantity::QuadraticDamping,
        range: Range::NON_NEGATIVE,
        meaning: "drag torque per velocity squared",
        default: None,
    }],
    tell_tale: "1/A grows linearly in time, so ln A bends up early, while the amplitude is large.",
    confused_with: &["damping_drift", "coulomb_friction"],
    reference: "Nayfeh, Mook, Nonlinear Oscillations, Wiley 1979, section 3.3.3",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[0.05],
};

/// Drag of a turbulent wake: −β·θ̇·|θ̇|. Its first derivative is continuous at rest, its second is not.
#[derive(Debug, Clone, Copy)]
pub struct QuadraticDrag;

impl Law for QuadraticDrag {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque("-{coefficient} * velocity * abs(velocity)");
    const DIRECTED: bool = true;

    fn torque<S: Scalar>(&[coefficient, ..]: &Values<S>, moment: &Moment<S>) -> S {
        -coefficient * moment.velocity * moment.velocity * moment.direction
    }
}
