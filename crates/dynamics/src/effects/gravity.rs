//! Weight of an unbalanced arm.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::{Export, Joint};
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "gravity",
    title: "Gravity",
    kind: Kind::System,
    class: Class::Conservative,
    equation: "-m g l sin(θ + φ)",
    latex: r"-mgl\,\sin(\theta+\varphi)",
    parameters: &[
        Parameter {
            name: "torque",
            symbol: "m g l",
            quantity: Quantity::Torque,
            range: Range::NON_NEGATIVE,
            meaning: "weight times its lever arm",
            default: None,
        },
        Parameter {
            name: "angle",
            symbol: "φ",
            quantity: Quantity::Angle,
            range: Range::TURN,
            meaning: "angle of the arm from hanging straight down at θ = 0",
            default: None,
        },
    ],
    tell_tale: "Frequency and mean position fall with A² in the fixed ratio of a sine.",
    confused_with: &["cubic_stiffness", "asymmetric_stiffness"],
    reference: "Baker, Blackburn, The Pendulum, Oxford 2005, chapter 3",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[150.0, 0.4],
};

/// Weight of an unbalanced arm: −m·g·l·sin(θ + φ).
#[derive(Debug, Clone, Copy)]
pub struct Gravity;

impl Law for Gravity {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export {
        joint: Joint::Weight { torque: "torque", angle: "angle" },
        ..Export::torque("-{torque} * sin(position + {angle})")
    };

    fn torque<S: Scalar>(&[torque, angle, ..]: &Values<S>, moment: &Moment<S>) -> S {
        -torque * (moment.position + angle).sin()
    }
}
