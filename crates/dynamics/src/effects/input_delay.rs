//! Delay of the command.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "input_delay",
    title: "Input delay",
    kind: Kind::System,
    class: Class::TimeDependent,
    equation: "τ(t - d) in place of τ(t)",
    latex: r"\tau(t-d)-\tau(t)",
    parameters: &[Parameter {
        name: "delay",
        symbol: "d",
        quantity: Quantity::Time,
        range: Range::NON_NEGATIVE,
        meaning: "time from command to torque",
        default: None,
    }],
    tell_tale: "A phase error that grows with frequency.",
    confused_with: &["sensor_lag"],
    reference: "Franklin, Powell, Workman, Digital Control of Dynamic Systems, 3rd ed., Addison-Wesley 1998, section 4.3",
    driven_only: true,
    hidden_states: 0,
    smooth: false,
    example: &[0.0031],
};

/// Command that arrives late: τ(t − d). The integrators read the delay and shift the input; before its first
/// value has arrived that value acts.
#[derive(Debug, Clone, Copy)]
pub struct InputDelay;

impl Law for InputDelay {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export { torque: None, ..Export::torque("") };

    fn torque<S: Scalar>(_: &Values<S>, _: &Moment<S>) -> S {
        S::from(0.0)
    }

    fn input_delay<S: Scalar>(&[delay, ..]: &Values<S>) -> Option<S> {
        Some(delay)
    }
}
