//! Derivative of the command.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "command_derivative",
    title: "Command derivative",
    kind: Kind::System,
    class: Class::TimeDependent,
    equation: "T·dτ/dt",
    latex: r"T\,\dot\tau",
    parameters: &[Parameter {
        name: "time",
        symbol: "T",
        quantity: Quantity::Time,
        range: Range::NON_NEGATIVE,
        meaning: "derivative time: gain of the command's rate over that of the command",
        default: None,
    }],
    tell_tale: "A phase lead that grows with the frequency of the command.",
    confused_with: &["input_delay"],
    reference: "Åström, Hägglund, PID Controllers, 2nd ed., Instrument Society of America 1995, section 3.3",
    driven_only: true,
    hidden_states: 0,
    smooth: true,
    example: &[0.02],
};

/// Loop that differentiates its error, and so the command: kp·(u − θ) + kd·(u̇ − θ̇) adds T·τ̇ with the torque
/// τ = kp·u of the input and T = kd/kp. A loop that differentiates the measured motion alone has no such term.
#[derive(Debug, Clone, Copy)]
pub struct CommandDerivative;

impl Law for CommandDerivative {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque("{time}*drive_rate");

    fn torque<S: Scalar>(&[time, ..]: &Values<S>, moment: &Moment<S>) -> S {
        time * moment.input_rate
    }
}
