//! Dry friction that falls with speed.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::error::DynamicsError;
use crate::export::Export;
use crate::law::{Law, Margins, Moment, Values};
use crate::nominal::Nominal;
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "stribeck_friction",
    title: "Stribeck friction",
    kind: Kind::System,
    class: Class::Dissipative,
    equation: "-[τ_c + (τ_s - τ_c) exp(-(θ′/v_s)²)] sign(θ′); at rest, the torque up to τ_s that holds the \
               body",
    latex: r"-\bigl[\tau_c+(\tau_s-\tau_c)\,e^{-(\dot\theta/v_s)^2}\bigr]\operatorname{sign}\dot\theta",
    parameters: &[
        Parameter {
            name: "torque",
            symbol: "τ_c",
            quantity: Quantity::Torque,
            range: Range::NON_NEGATIVE,
            meaning: "friction torque at high speed",
            default: None,
        },
        Parameter {
            name: "static_torque",
            symbol: "τ_s",
            quantity: Quantity::Torque,
            range: Range::NON_NEGATIVE,
            meaning: "friction torque at rest, at least τ_c",
            default: None,
        },
        Parameter {
            name: "velocity",
            symbol: "v_s",
            quantity: Quantity::Velocity,
            range: Range::POSITIVE,
            meaning: "speed at which the excess has fallen to 1/e",
            default: None,
        },
    ],
    tell_tale: "As Coulomb friction, with a faster decay once the peak speed nears v_s.",
    confused_with: &["coulomb_friction"],
    reference: "Armstrong-Hélouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083, equation 9",
    driven_only: false,
    hidden_states: 0,
    smooth: false,
    example: &[0.5, 1.0, 2.0],
};

/// Dry friction that falls with speed: −[τ_c + (τ_s − τ_c)·exp(−(θ̇/v_s)²)]·sign(θ̇). At rest it holds
/// against up to τ_s.
///
/// Regions: 1 below 6.01·v_s; 0 above it, where the excess is below rounding and left out. With these regions
/// the narrow peak at slow speed cannot slip between the steps of an integrator.
#[derive(Debug, Clone, Copy)]
pub struct StribeckFriction;

/// Speed in units of v_s above which exp(−(θ̇/v_s)²) is below 2^−52.
const FAST: f64 = 6.01;

impl Law for StribeckFriction {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque(
        "-({torque} + ({static_torque} - {torque}) * exp(-(velocity / {velocity}) * (velocity / {velocity}))) \
         * direction",
    );
    const DIRECTED: bool = true;

    fn torque<S: Scalar>(&[torque, static_torque, velocity, _]: &Values<S>, moment: &Moment<S>) -> S {
        match moment.region {
            0 => -torque * moment.direction,
            _ => {
                let speed = moment.velocity / velocity;
                let excess = (static_torque - torque) * (-(speed * speed)).exp();
                -(torque + excess) * moment.direction
            }
        }
    }

    fn holding_torque<S: Scalar>(&[_, static_torque, ..]: &Values<S>, _: &Moment<S>) -> Option<S> {
        Some(static_torque)
    }

    fn region(&[_, _, velocity, _]: &Values<f64>, moment: &Moment<f64>) -> i8 {
        i8::from(moment.velocity.abs() <= FAST * velocity)
    }

    fn margins<S: Scalar>(&[_, _, velocity, _]: &Values<S>, moment: &Moment<S>) -> Margins<S> {
        let above = moment.velocity * moment.direction - velocity * FAST;
        match moment.region {
            _ if moment.direction == 0.0 => [None, None],
            0 => [Some(above), None],
            _ => [Some(-above), None],
        }
    }

    fn beyond(region: i8, _: usize) -> i8 {
        1 - region
    }

    fn check(&[torque, static_torque, ..]: &Values<f64>, _: &Nominal) -> Result<(), DynamicsError> {
        if static_torque >= torque {
            return Ok(());
        }
        Err(DynamicsError::Contradiction {
            effect: DESCRIPTION.id,
            parameter: "static_torque",
            value: static_torque,
            relation: "at least",
            bound: torque,
            reason: "the friction torque at high speed",
        })
    }
}
