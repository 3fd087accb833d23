//! Limit of a servo's whole torque.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Margins, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "torque_limit",
    title: "Torque limit",
    kind: Kind::System,
    class: Class::TimeDependent,
    equation: "clip(τ_d, ±τ_max) - τ_d, where τ_d = τ - k (θ - θ_rest) - c θ′ is the drive's torque",
    latex: r"\operatorname{clip}(\tau_d,\pm\tau_\mathrm{max})-\tau_d,\quad \tau_d=\tau-k(\theta-\theta_\mathrm{rest})-c\dot\theta",
    parameters: &[Parameter {
        name: "torque",
        symbol: "τ_max",
        quantity: Quantity::Torque,
        range: Range::POSITIVE,
        meaning: "largest torque of the drive, its spring and damping included",
        default: None,
    }],
    tell_tale: "Large steps of the command start with the same acceleration, whatever their size.",
    confused_with: &["input_saturation"],
    reference: "Khalil, Nonlinear Systems, 3rd ed., Prentice Hall 2002, section 1.2",
    driven_only: true,
    hidden_states: 0,
    smooth: false,
    example: &[180.0],
};

/// Limit of a servo's whole torque. Spring and damping of a servo are software, so that its torque
/// τ_d = τ − k·(θ − θ_rest) − c·θ̇ is clipped at ±τ_max, which adds clip(τ_d, ±τ_max) − τ_d. The limit of the
/// input's torque alone is [`InputSaturation`](super::InputSaturation).
///
/// Regions: 0 while the torque passes, ±1 while it is clipped.
#[derive(Debug, Clone, Copy)]
pub struct TorqueLimit;

impl Law for TorqueLimit {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque(
        "min(max(drive - stiffness * (position - rest_angle) - damping * velocity, -{torque}), {torque}) \
         - (drive - stiffness * (position - rest_angle) - damping * velocity)",
    );

    fn torque<S: Scalar>(&[limit, ..]: &Values<S>, moment: &Moment<S>) -> S {
        match moment.region {
            0 => S::from(0.0),
            side => limit * f64::from(side) - moment.drive_torque(),
        }
    }

    fn region(&[limit, ..]: &Values<f64>, moment: &Moment<f64>) -> i8 {
        match moment.drive_torque() {
            above if above > limit => 1,
            below if below < -limit => -1,
            _ => 0,
        }
    }

    fn margins<S: Scalar>(&[limit, ..]: &Values<S>, moment: &Moment<S>) -> Margins<S> {
        let torque = moment.drive_torque();
        match moment.region {
            0 => [Some(limit - torque), Some(limit + torque)],
            side => [Some(torque * f64::from(side) - limit), None],
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
