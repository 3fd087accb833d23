//! Torque without a name that repeats along the position.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "unknown",
    title: "Torque without a name",
    kind: Kind::System,
    class: Class::Conservative,
    equation: "-τ sin(n θ + φ)",
    latex: r"-\tau\,\sin(n\,\theta+\varphi)",
    parameters: &[
        Parameter {
            name: "torque",
            symbol: "τ",
            quantity: Quantity::Torque,
            range: Range::NON_NEGATIVE,
            meaning: "amplitude of the torque",
            default: None,
        },
        Parameter {
            name: "wavenumber",
            symbol: "n",
            quantity: Quantity::Wavenumber,
            range: Range::POSITIVE,
            meaning: "radians of the sine per radian or meter of the position; for an angle, the number of \
                      waves per turn",
            default: None,
        },
        Parameter {
            name: "phase",
            symbol: "φ",
            quantity: Quantity::Angle,
            range: Range::TURN,
            meaning: "phase of the sine at position 0",
            default: None,
        },
    ],
    tell_tale: "The frequency rises and falls as the swing decays, because its turning points pass one wave \
                after another.",
    confused_with: &[],
    reference: "Hanselman, Brushless Permanent Magnet Motor Design, 2nd ed., The Writers' Collective 2003, chapter 5",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[8.0, 18.0, 0.7],
};

/// Torque without a name that repeats along the position: −τ·sin(n·θ + φ).
///
/// It is not an effect of the vocabulary: magnets, bearings and screws all cause it, and a record does not
/// tell them apart. The reference is for one of these causes, the cogging of a motor.
#[derive(Debug, Clone, Copy)]
pub struct PositionTorque;

impl Law for PositionTorque {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque("-{torque} * sin({wavenumber} * position + {phase})");

    fn torque<S: Scalar>(&[torque, wavenumber, phase, _]: &Values<S>, moment: &Moment<S>) -> S {
        -torque * (wavenumber * moment.position + phase).sin()
    }
}
