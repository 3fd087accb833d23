//! Stop on one side.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::error::DynamicsError;
use crate::export::Export;
use crate::law::{Law, Margins, Moment, Values};
use crate::nominal::Nominal;
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "end_stop",
    title: "End stop",
    kind: Kind::System,
    class: Class::Conservative,
    equation: "-k_s p max(0, 1 + χ p′) away from the stop, where p > 0 is the depth beyond θ_s",
    latex: r"\mp k_s\,p\,\max(0,\,1+\chi\dot p),\quad p=\max(0,\,\pm(\theta-\theta_s))",
    parameters: &[
        Parameter {
            name: "angle",
            symbol: "θ_s",
            quantity: Quantity::Position,
            range: Range::ANY,
            meaning: "where contact begins; the stop lies on the far side from the rest angle",
            default: None,
        },
        Parameter {
            name: "stiffness",
            symbol: "k_s",
            quantity: Quantity::Stiffness,
            range: Range::POSITIVE,
            meaning: "stiffness of the contact",
            default: None,
        },
        Parameter {
            name: "dissipation",
            symbol: "χ",
            quantity: Quantity::InverseVelocity,
            range: Range::NON_NEGATIVE,
            meaning: "loss of the contact per approach speed",
            default: None,
        },
    ],
    tell_tale: "The motion looks clipped on one side, but only while A is large.",
    confused_with: &["sensor_saturation"],
    reference: "Hunt, Crossley, Journal of Applied Mechanics 42 (1975) 440, with a linear contact spring",
    driven_only: false,
    hidden_states: 0,
    smooth: false,
    example: &[-0.5, 20_000.0, 0.05],
};

/// Stop on one side (Hunt–Crossley contact with a linear spring): the torque −k_s·p·max(0, 1 + χ·ṗ) away from
/// the stop, where p > 0 is the depth beyond θ_s. It starts from zero at contact, takes energy out, and never
/// pulls. The stop lies on the side of θ_s away from the rest angle. It is also the contact of a joint with an
/// obstacle at an angle, stiff and damped.
///
/// Regions, positive for a stop above the rest angle and negative for one below: ±1 free, ±2 pressing, ±3 in
/// contact but receding faster than the contact can follow.
#[derive(Debug, Clone, Copy)]
pub struct EndStop;

const FREE: i8 = 1;
const PRESSING: i8 = 2;
const RECEDING: i8 = 3;

/// Returns the side of the stop: 1 above the rest angle, −1 below.
fn side(region: i8) -> f64 {
    f64::from(region.signum())
}

fn depth<S: Scalar>(angle: S, moment: &Moment<S>) -> S {
    (moment.position - angle) * side(moment.region)
}

/// Returns the contact torque in units of the spring's: 1 + χ·ṗ.
fn factor<S: Scalar>(dissipation: S, moment: &Moment<S>) -> S {
    dissipation * moment.velocity * side(moment.region) + 1.0
}

impl Law for EndStop {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque(
        "-sign({angle} - rest_angle) * {stiffness} * max(0, sign({angle} - rest_angle) * (position - {angle})) \
         * max(0, 1 + {dissipation} * sign({angle} - rest_angle) * velocity)",
    );

    fn torque<S: Scalar>(&[angle, stiffness, dissipation, _]: &Values<S>, moment: &Moment<S>) -> S {
        match moment.region.abs() {
            PRESSING => -stiffness * depth(angle, moment) * factor(dissipation, moment) * side(moment.region),
            _ => S::from(0.0),
        }
    }

    fn region(&[angle, _, dissipation, _]: &Values<f64>, moment: &Moment<f64>) -> i8 {
        let side = if angle >= moment.nominal.rest_angle { 1 } else { -1 };
        let moment = Moment { region: side, ..*moment };
        side * match (depth(angle, &moment), factor(dissipation, &moment)) {
            (depth, _) if depth <= 0.0 => FREE,
            (_, factor) if factor < 0.0 => RECEDING,
            _ => PRESSING,
        }
    }

    fn margins<S: Scalar>(&[angle, _, dissipation, _]: &Values<S>, moment: &Moment<S>) -> Margins<S> {
        let depth = depth(angle, moment);
        let factor = factor(dissipation, moment);
        match moment.region.abs() {
            FREE => [Some(-depth), None],
            PRESSING => [Some(depth), Some(factor)],
            _ => [Some(depth), Some(-factor)],
        }
    }

    fn beyond(region: i8, edge: usize) -> i8 {
        region.signum()
            * match (region.abs(), edge) {
                (FREE, _) => PRESSING,
                (PRESSING, 1) => RECEDING,
                (RECEDING, 1) => PRESSING,
                _ => FREE,
            }
    }

    fn check(&[angle, ..]: &Values<f64>, nominal: &Nominal) -> Result<(), DynamicsError> {
        if angle != nominal.rest_angle() {
            return Ok(());
        }
        Err(DynamicsError::Contradiction {
            effect: DESCRIPTION.id,
            parameter: "angle",
            value: angle,
            relation: "above or below",
            bound: nominal.rest_angle(),
            reason: "the rest angle, which tells the stop's side",
        })
    }
}
