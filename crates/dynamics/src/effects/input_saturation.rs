//! Limit of the drive's torque.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Margins, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "input_saturation",
    title: "Input saturation",
    kind: Kind::System,
    class: Class::TimeDependent,
    equation: "clip(τ, ±τ_max) - τ",
    latex: r"\operatorname{clip}(\tau,\pm\tau_\mathrm{max})-\tau",
    parameters: &[Parameter {
        name: "torque",
        symbol: "τ_max",
        quantity: Quantity::Torque,
        range: Range::POSITIVE,
        meaning: "largest torque of the drive",
        default: None,
    }],
    tell_tale: "A gap only where the command is large.",
    confused_with: &[],
    reference: "Khalil, Nonlinear Systems, 3rd ed., Prentice Hall 2002, section 1.2",
    driven_only: true,
    hidden_states: 0,
    smooth: false,
    example: &[8.0],
};

/// Limit of the drive's torque: the input's torque is clipped at ±τ_max, which adds clip(τ, ±τ_max) − τ.
///
/// Regions: 0 while the input passes, ±1 while it is clipped.
#[derive(Debug, Clone, Copy)]
pub struct InputSaturation;

impl Law for InputSaturation {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque("min(max(drive, -{torque}), {torque}) - drive");

    fn torque<S: Scalar>(&[limit, ..]: &Values<S>, moment: &Moment<S>) -> S {
        match moment.region {
            0 => S::from(0.0),
            side => limit * f64::from(side) - moment.input,
        }
    }

    fn region(&[limit, ..]: &Values<f64>, moment: &Moment<f64>) -> i8 {
        match moment.input {
            above if above > limit => 1,
            below if below < -limit => -1,
            _ => 0,
        }
    }

    fn margins<S: Scalar>(&[limit, ..]: &Values<S>, moment: &Moment<S>) -> Margins<S> {
        match moment.region {
            0 => [Some(limit - moment.input), Some(limit + moment.input)],
            side => [Some(moment.input * f64::from(side) - limit), None],
        }
    }

    fn beyond(region: i8, edge: usize) -> i8 {
        match (region, edge) {
            (0, 0) => 1,
            (0, _) => -1,
            _ => 0,
        }
    }
}
