//! Dry friction of constant size.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::{Export, Joint};
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "coulomb_friction",
    title: "Coulomb friction",
    kind: Kind::System,
    class: Class::Dissipative,
    equation: "-τ_c sign(θ′); at rest, the torque up to τ_c that holds the body",
    latex: r"-\tau_c\,\operatorname{sign}\dot\theta",
    parameters: &[Parameter {
        name: "torque",
        symbol: "τ_c",
        quantity: Quantity::Torque,
        range: Range::NON_NEGATIVE,
        meaning: "size of the friction torque",
        default: None,
    }],
    tell_tale: "The amplitude falls by the same 4τ_c/k every cycle, so ln A bends down at the end; the motion stops anywhere within ±τ_c/k.",
    confused_with: &["hysteresis", "stribeck_friction", "sensor_quantization"],
    reference: "Feeny, Liang, Journal of Sound and Vibration 195 (1996) 149",
    driven_only: false,
    hidden_states: 0,
    smooth: false,
    example: &[1.0],
};

/// Dry friction of constant size: −τ_c·sign(θ̇). At rest it holds against up to τ_c.
#[derive(Debug, Clone, Copy)]
pub struct CoulombFriction;

impl Law for CoulombFriction {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export =
        Export { joint: Joint::Friction("torque"), ..Export::torque("-{torque} * direction") };
    const DIRECTED: bool = true;

    fn torque<S: Scalar>(&[torque, ..]: &Values<S>, moment: &Moment<S>) -> S {
        -torque * moment.direction
    }

    fn holding_torque<S: Scalar>(&[torque, ..]: &Values<S>, _: &Moment<S>) -> Option<S> {
        Some(torque)
    }
}
