//! Viscous damping that changes with time.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "damping_drift",
    title: "Damping drift",
    kind: Kind::System,
    class: Class::TimeDependent,
    equation: "-c α t θ′: the damping is c (1 + α t)",
    latex: r"-c\,\alpha\,t\,\dot\theta",
    parameters: &[Parameter {
        name: "rate",
        symbol: "α",
        quantity: Quantity::Rate,
        range: Range::ANY,
        meaning: "relative change of the damping per second",
        default: None,
    }],
    tell_tale: "The decay rate drifts with time, not with amplitude.",
    confused_with: &["coulomb_friction", "quadratic_drag"],
    reference: "Feldman, Hilbert Transform Applications in Mechanical Vibration, Wiley 2011, chapter 9",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[0.02],
};

/// Viscous damping that changes with time: c·(1 + α·t), which adds −c·α·t·θ̇. Time counts from 0 of the
/// record's own clock.
#[derive(Debug, Clone, Copy)]
pub struct DampingDrift;

impl Law for DampingDrift {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque("-damping * {rate} * time * velocity");

    fn torque<S: Scalar>(&[rate, ..]: &Values<S>, moment: &Moment<S>) -> S {
        -moment.nominal.damping * rate * moment.time * moment.velocity
    }
}
