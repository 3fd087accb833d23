//! Spring that changes with time.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "stiffness_drift",
    title: "Stiffness drift",
    kind: Kind::System,
    class: Class::TimeDependent,
    equation: "-k α t (θ - θ_rest): the stiffness is k (1 + α t)",
    latex: r"-k\,\alpha\,t\,(\theta-\theta_\mathrm{rest})",
    parameters: &[Parameter {
        name: "rate",
        symbol: "α",
        quantity: Quantity::Rate,
        range: Range::ANY,
        meaning: "relative change of the stiffness per second",
        default: None,
    }],
    tell_tale: "The frequency drifts with time, not with amplitude.",
    confused_with: &["cubic_stiffness", "clock_drift"],
    reference: "Feldman, Hilbert Transform Applications in Mechanical Vibration, Wiley 2011, chapter 9",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[0.002],
};

/// Spring that changes with time: its stiffness is k·(1 + α·t), which adds −k·α·t·(θ − θ_rest). Time counts
/// from 0 of the record's own clock.
#[derive(Debug, Clone, Copy)]
pub struct StiffnessDrift;

impl Law for StiffnessDrift {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque("-stiffness * {rate} * time * (position - rest_angle)");

    fn torque<S: Scalar>(&[rate, ..]: &Values<S>, moment: &Moment<S>) -> S {
        let deflection = moment.position - moment.nominal.rest_angle;
        -moment.nominal.stiffness * rate * moment.time * deflection
    }
}
