//! Dry friction that changes with time.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "friction_drift",
    title: "Friction drift",
    kind: Kind::System,
    class: Class::Dissipative,
    equation: "-τ_c exp(α t) sign(θ′); at rest, the torque up to τ_c exp(α t) that holds the body",
    latex: r"-\tau_c\,e^{\alpha t}\operatorname{sign}\dot\theta",
    parameters: &[
        Parameter {
            name: "torque",
            symbol: "τ_c",
            quantity: Quantity::Torque,
            range: Range::NON_NEGATIVE,
            meaning: "size of the friction torque at time 0",
            default: None,
        },
        Parameter {
            name: "rate",
            symbol: "α",
            quantity: Quantity::Rate,
            range: Range::ANY,
            meaning: "relative change of the friction torque per second; below 0 as a joint warms",
            default: None,
        },
    ],
    tell_tale: "As Coulomb friction, whose size drifts with time.",
    confused_with: &["coulomb_friction", "damping_drift"],
    reference: "Bittencourt, Gunnarsson, Journal of Dynamic Systems, Measurement, and Control 134 (2012) 051013",
    driven_only: false,
    hidden_states: 0,
    smooth: false,
    example: &[1.0, -0.05],
};

/// Dry friction that falls as a joint warms, or grows: −τ_c·exp(α·t)·sign(θ̇). At rest it holds against up to
/// τ_c·exp(α·t). Time counts from 0 of the record's own clock, as for
/// [`DampingDrift`](super::DampingDrift); unlike a linear change, an exponential one never changes its sign.
#[derive(Debug, Clone, Copy)]
pub struct FrictionDrift;

/// Returns the size of the friction torque.
fn size<S: Scalar>(&[torque, rate, ..]: &Values<S>, moment: &Moment<S>) -> S {
    torque * (rate * moment.time).exp()
}

impl Law for FrictionDrift {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque("-{torque} * exp({rate} * time) * direction");
    const DIRECTED: bool = true;

    fn torque<S: Scalar>(values: &Values<S>, moment: &Moment<S>) -> S {
        -size(values, moment) * moment.direction
    }

    fn holding_torque<S: Scalar>(values: &Values<S>, moment: &Moment<S>) -> Option<S> {
        Some(size(values, moment))
    }
}
