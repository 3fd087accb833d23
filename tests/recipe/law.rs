//! Damping that grows away from the middle.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "sine_drag",
    title: "Sine drag",
    kind: Kind::System,
    class: Class::Dissipative,
    equation: "-c θ′ sin(θ)²",
    latex: r"-c\,\dot\theta\,\sin^2\theta",
    parameters: &[Parameter {
        name: "coefficient",
        symbol: "c",
        quantity: Quantity::Damping,
        range: Range::ANY,
        meaning: "damping a quarter turn away from the middle",
        default: None,
    }],
    tell_tale: "The decay rate falls with A², and goes on to a rate of its own.",
    confused_with: &["quadratic_drag"],
    reference: "Nayfeh, Mook, Nonlinear Oscillations, Wiley 1979, section 3.3",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[2.0],
};

/// Damping that grows away from the middle: −c·θ̇·sin²θ.
#[derive(Debug, Clone, Copy)]
pub struct SineDrag;

impl Law for SineDrag {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque("-{coefficient} * velocity * sin(position) * sin(position)");

    fn torque<S: Scalar>(&[coefficient, ..]: &Values<S>, moment: &Moment<S>) -> S {
        let sine = moment.position.sin();
        -coefficient * moment.velocity * sine * sine
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::at;

    #[test]
    fn the_sign_is_that_of_the_equation() {
        let found = SineDrag::torque(&[0.7, 0.0, 0.0, 0.0], &at(0.5, 0.8, 0));
        assert!((found + 0.7 * 0.8 * 0.5_f64.sin().powi(2)).abs() < 1e-15, "{found}");
    }
}
