//! Dry friction that grows with the load.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Margins, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "load_friction",
    title: "Load-dependent friction",
    kind: Kind::System,
    class: Class::Dissipative,
    equation: "-(τ_0 + μ |τ_d|) sign(θ′), where τ_d = τ - k (θ - θ_rest) - c θ′ is the drive's torque; at rest, \
               the torque up to τ_0 + μ |τ_d| that holds the body",
    latex: r"-(\tau_0+\mu\,|\tau_d|)\operatorname{sign}\dot\theta,\quad \tau_d=\tau-k(\theta-\theta_\mathrm{rest})-c\dot\theta",
    parameters: &[
        Parameter {
            name: "torque",
            symbol: "τ_0",
            quantity: Quantity::Torque,
            range: Range::NON_NEGATIVE,
            meaning: "size of the friction torque without load",
            default: None,
        },
        Parameter {
            name: "coefficient",
            symbol: "μ",
            quantity: Quantity::Ratio,
            range: Range::NON_NEGATIVE,
            meaning: "friction torque per torque of the drive; from 1 on the drive cannot move the body",
            default: None,
        },
    ],
    tell_tale: "As Coulomb friction, but larger where the drive pulls harder: after large steps, or against a weight.",
    confused_with: &["coulomb_friction", "stribeck_friction"],
    reference: "Duclusaud, Passault, Padois, Ly, arXiv:2410.08650 (2024), model M3",
    driven_only: true,
    hidden_states: 0,
    smooth: false,
    example: &[0.3, 0.004],
};

/// Dry friction of a gear that grows with the torque it transmits: −(τ₀ + μ·|τ_d|)·sign(θ̇), where
/// τ_d = τ − k·(θ − θ_rest) − c·θ̇ is the torque of a servo's drive. At rest it holds against up to τ₀ + μ·|τ_d|.
///
/// Regions: 1 while the drive's torque is positive, −1 while it is negative.
#[derive(Debug, Clone, Copy)]
pub struct LoadFriction;

/// Returns the size of the friction torque.
fn size<S: Scalar>(&[torque, coefficient, ..]: &Values<S>, moment: &Moment<S>) -> S {
    torque + coefficient * moment.drive_torque() * f64::from(moment.region)
}

impl Law for LoadFriction {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque(
        "-({torque} + {coefficient} * abs(drive - stiffness * (position - rest_angle) - damping * velocity)) \
         * direction",
    );
    const DIRECTED: bool = true;

    fn torque<S: Scalar>(values: &Values<S>, moment: &Moment<S>) -> S {
        -size(values, moment) * moment.direction
    }

    fn holding_torque<S: Scalar>(values: &Values<S>, moment: &Moment<S>) -> Option<S> {
        Some(size(values, moment))
    }

    fn region(_: &Values<f64>, moment: &Moment<f64>) -> i8 {
        if moment.drive_torque() < 0.0 { -1 } else { 1 }
    }

    fn margins<S: Scalar>(_: &Values<S>, moment: &Moment<S>) -> Margins<S> {
        [Some(moment.drive_torque() * f64::from(moment.region)), None]
    }

    fn beyond(region: i8, _: usize) -> i8 {
        -region
    }
}
