//! Stiffness without a name, of higher order than those of the vocabulary.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "unlisted_stiffness",
    title: "Stiffness without a name",
    kind: Kind::System,
    class: Class::Conservative,
    equation: "-k_5 (θ - θ_rest)⁵",
    latex: r"-k_5\,(\theta-\theta_\mathrm{rest})^5",
    parameters: &[Parameter {
        name: "coefficient",
        symbol: "k_5",
        quantity: Quantity::QuinticStiffness,
        range: Range::ANY,
        meaning: "torque per deflection to the fifth power; above 0 hardens",
        default: None,
    }],
    tell_tale: "The frequency changes as A⁴, with odd harmonics.",
    confused_with: &[],
    reference: "Kovacic, Brennan, The Duffing Equation, Wiley 2011, chapter 2",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[400.0],
};

/// Stiffness without a name: −k₅·(θ − θ_rest)⁵.
///
/// It is not an effect of the vocabulary, and represents nonlinear springs of another power than the square
/// or the cube.
#[derive(Debug, Clone, Copy)]
pub struct UnlistedStiffness;

impl Law for UnlistedStiffness {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque(
        "-{coefficient} * (position - rest_angle) * (position - rest_angle) * (position - rest_angle) \
         * (position - rest_angle) * (position - rest_angle)",
    );

    fn torque<S: Scalar>(&[coefficient, ..]: &Values<S>, moment: &Moment<S>) -> S {
        let deflection = moment.position - moment.nominal.rest_angle;
        -coefficient * (deflection * deflection * deflection * deflection * deflection)
    }
}
