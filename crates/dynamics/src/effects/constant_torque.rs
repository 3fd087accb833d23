//! Preload.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::{Export, Joint};
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "constant_torque",
    title: "Constant torque",
    kind: Kind::System,
    class: Class::Conservative,
    equation: "+τ_0",
    latex: r"+\tau_0",
    parameters: &[Parameter {
        name: "torque",
        symbol: "τ_0",
        quantity: Quantity::Torque,
        range: Range::ANY,
        meaning: "the preload",
        default: None,
    }],
    tell_tale: "A shifted mean and nothing else.",
    confused_with: &["sensor_drift", "asymmetric_stiffness"],
    reference: "Den Hartog, Mechanical Vibrations, 4th ed., McGraw-Hill 1956, section 2.1",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[9.0],
};

/// Preload: +τ₀. The rest position is then θ_rest + τ₀/k.
#[derive(Debug, Clone, Copy)]
pub struct ConstantTorque;

impl Law for ConstantTorque {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export { joint: Joint::SpringShift("torque"), ..Export::torque("{torque}") };

    fn torque<S: Scalar>(&[torque, ..]: &Values<S>, _: &Moment<S>) -> S {
        torque
    }
}
