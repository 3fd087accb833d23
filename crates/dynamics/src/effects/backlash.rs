//! Play between the spring and the body.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Margins, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "backlash",
    title: "Backlash",
    kind: Kind::System,
    class: Class::Conservative,
    equation: "+k sat(θ - θ_rest, ±b): the spring acts only on the deflection beyond ±b",
    latex: r"+k\,\operatorname{sat}_b(\theta-\theta_\mathrm{rest})",
    parameters: &[Parameter {
        name: "half_width",
        symbol: "b",
        quantity: Quantity::Position,
        range: Range::POSITIVE,
        meaning: "half the width of the dead zone",
        default: None,
    }],
    tell_tale: "The frequency falls as A nears b.",
    confused_with: &["cubic_stiffness"],
    reference: "Nordin, Gutman, Automatica 38 (2002) 1633, dead-zone model",
    driven_only: false,
    hidden_states: 0,
    smooth: false,
    example: &[0.01],
};

/// Play between the spring and the body: the nominal spring's torque gets a dead zone of ±b around the rest
/// angle, which adds +k·sat(θ − θ_rest, ±b).
///
/// Regions: 0 inside the dead zone, ±1 beyond it.
#[derive(Debug, Clone, Copy)]
pub struct Backlash;

fn deflection<S: Scalar>(moment: &Moment<S>) -> S {
    moment.position - moment.nominal.rest_angle
}

impl Law for Backlash {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export =
        Export::torque("stiffness * min(max(position - rest_angle, -{half_width}), {half_width})");

    fn torque<S: Scalar>(&[half_width, ..]: &Values<S>, moment: &Moment<S>) -> S {
        match moment.region {
            0 => moment.nominal.stiffness * deflection(moment),
            side => moment.nominal.stiffness * half_width * f64::from(side),
        }
    }

    fn region(&[half_width, ..]: &Values<f64>, moment: &Moment<f64>) -> i8 {
        match deflection(moment) {
            above if above > half_width => 1,
            below if below < -half_width => -1,
            _ => 0,
        }
    }

    fn margins<S: Scalar>(&[half_width, ..]: &Values<S>, moment: &Moment<S>) -> Margins<S> {
        let deflection = deflection(moment);
        match moment.region {
            0 => [Some(half_width - deflection), Some(half_width + deflection)],
            side => [Some(deflection * f64::from(side) - half_width), None],
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
