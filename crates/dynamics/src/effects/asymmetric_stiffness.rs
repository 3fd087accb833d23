//! Spring that is stiffer on one side.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "asymmetric_stiffness",
    title: "Asymmetric stiffness",
    kind: Kind::System,
    class: Class::Conservative,
    equation: "-k_2 (θ - θ_rest)²",
    latex: r"-k_2\,(\theta-\theta_\mathrm{rest})^2",
    parameters: &[Parameter {
        name: "coefficient",
        symbol: "k_2",
        quantity: Quantity::QuadraticStiffness,
        range: Range::ANY,
        meaning: "torque per deflection squared",
        default: None,
    }],
    tell_tale: "The mean position moves as A², with even harmonics.",
    confused_with: &["gravity", "sensor_nonlinearity"],
    reference: "Nayfeh, Mook, Nonlinear Oscillations, Wiley 1979, section 2.3",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[60.0],
};

/// Spring that is stiffer on one side: −k₂·(θ − θ_rest)².
#[derive(Debug, Clone, Copy)]
pub struct AsymmetricStiffness;

impl Law for AsymmetricStiffness {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export =
        Export::torque("-{coefficient} * (position - rest_angle) * (position - rest_angle)");

    fn torque<S: Scalar>(&[coefficient, ..]: &Values<S>, moment: &Moment<S>) -> S {
        let deflection = moment.position - moment.nominal.rest_angle;
        -coefficient * (deflection * deflection)
    }
}
