//! Dry friction that differs by direction.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::error::DynamicsError;
use crate::export::Export;
use crate::law::{Law, Moment, Values};
use crate::nominal::Nominal;
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "directional_friction",
    title: "Directional friction",
    kind: Kind::System,
    class: Class::Dissipative,
    equation: "-τ_c sign(θ′) - δ/2; at rest, the torque from -(τ_c - δ/2) to τ_c + δ/2 that holds the body",
    latex: r"-\tau_c\,\operatorname{sign}\dot\theta-\tfrac{1}{2}\delta",
    parameters: &[
        Parameter {
            name: "torque",
            symbol: "τ_c",
            quantity: Quantity::Torque,
            range: Range::NON_NEGATIVE,
            meaning: "mean size of the friction torque in the two directions",
            default: None,
        },
        Parameter {
            name: "difference",
            symbol: "δ",
            quantity: Quantity::Torque,
            range: Range::ANY,
            meaning: "size in the positive direction less that in the negative one; at most 2τ_c",
            default: None,
        },
    ],
    tell_tale: "As Coulomb friction and a constant torque together.",
    confused_with: &["coulomb_friction"],
    reference: "Duclusaud, Passault, Padois, Ly, arXiv:2410.08650 (2024), model M5",
    driven_only: false,
    hidden_states: 0,
    smooth: false,
    example: &[1.0, 0.8],
};

/// Dry friction of τ_c + δ/2 against motion in the positive direction and of τ_c − δ/2 against motion in the
/// negative one: −τ_c·sign(θ̇) − δ/2. At rest it holds against torques from −(τ_c − δ/2) to τ_c + δ/2.
///
/// This is Coulomb friction τ_c beside a constant torque −δ/2, moving and at rest alike: a constant torque shifts
/// the torques up to which Coulomb friction holds by as much. No record can tell the two apart.
#[derive(Debug, Clone, Copy)]
pub struct DirectionalFriction;

impl Law for DirectionalFriction {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque("-{torque} * direction - {difference} / 2");
    const DIRECTED: bool = true;

    fn torque<S: Scalar>(&[torque, difference, ..]: &Values<S>, moment: &Moment<S>) -> S {
        -torque * moment.direction - difference * 0.5
    }

    fn holding_torque<S: Scalar>(&[torque, ..]: &Values<S>, _: &Moment<S>) -> Option<S> {
        Some(torque)
    }

    fn check(&[torque, difference, ..]: &Values<f64>, _: &Nominal) -> Result<(), DynamicsError> {
        if difference.abs() <= 2.0 * torque {
            return Ok(());
        }
        Err(DynamicsError::Contradiction {
            effect: DESCRIPTION.id,
            parameter: "difference",
            value: difference,
            relation: "within ±",
            bound: 2.0 * torque,
            reason: "twice the mean torque, since friction drives in no direction",
        })
    }
}
