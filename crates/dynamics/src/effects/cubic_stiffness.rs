//! Spring that hardens or softens symmetrically.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "cubic_stiffness",
    title: "Cubic stiffness",
    kind: Kind::System,
    class: Class::Conservative,
    equation: "-k_3 (θ - θ_rest)³",
    latex: r"-k_3\,(\theta-\theta_\mathrm{rest})^3",
    parameters: &[Parameter {
        name: "coefficient",
        symbol: "k_3",
        quantity: Quantity::CubicStiffness,
        range: Range::ANY,
        meaning: "torque per deflection cubed; above 0 hardens",
        default: None,
    }],
    tell_tale: "The frequency changes as A², with odd harmonics.",
    confused_with: &["gravity", "backlash", "stiffness_drift"],
    reference: "Kovacic, Brennan, The Duffing Equation, Wiley 2011, chapter 2",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[120.0],
};

/// Spring that hardens or softens symmetrically: −k₃·(θ − θ_rest)³.
#[derive(Debug, Clone, Copy)]
pub struct CubicStiffness;

impl Law for CubicStiffness {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque(
        "-{coefficient} * (position - rest_angle) * (position - rest_angle) * (position - rest_angle)",
    );

    fn torque<S: Scalar>(&[coefficient, ..]: &Values<S>, moment: &Moment<S>) -> S {
        let deflection = moment.position - moment.nominal.rest_angle;
        -coefficient * (deflection * deflection * deflection)
    }
}
