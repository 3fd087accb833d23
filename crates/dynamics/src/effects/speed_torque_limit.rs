//! Limit of a servo's torque that falls with speed.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Margins, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "speed_torque_limit",
    title: "Speed-dependent torque limit",
    kind: Kind::System,
    class: Class::TimeDependent,
    equation: "clip(τ_d, -τ_max, τ_max (1 - |θ′|/v_0)) - τ_d, positive along the motion, where \
               τ_d = τ - k (θ - θ_rest) - c θ′ is the drive's torque",
    latex: r"\operatorname{clip}\bigl(\tau_d,-\tau_\mathrm{max},\tau_\mathrm{max}(1-|\dot\theta|/v_0)\bigr)-\tau_d",
    parameters: &[
        Parameter {
            name: "torque",
            symbol: "τ_max",
            quantity: Quantity::Torque,
            range: Range::POSITIVE,
            meaning: "largest torque of the drive at rest and against the motion",
            default: None,
        },
        Parameter {
            name: "no_load_speed",
            symbol: "v_0",
            quantity: Quantity::Velocity,
            range: Range::POSITIVE,
            meaning: "speed at which the drive has no torque left along the motion",
            default: None,
        },
    ],
    tell_tale: "Large steps of the command run at nearly one speed, whatever their size.",
    confused_with: &["torque_limit", "input_saturation"],
    reference: "Krishnan, Electric Motor Drives, Prentice Hall 2001, chapter 3",
    driven_only: true,
    hidden_states: 0,
    smooth: false,
    example: &[250.0, 30.0],
};

/// Limit of a servo's torque by the supply's voltage: along the motion the drive's torque
/// τ_d = τ − k·(θ − θ_rest) − c·θ̇ reaches at most τ_max·(1 − |θ̇|/v₀), since the motor's own voltage grows with its
/// speed; against the motion it reaches τ_max. Beyond v₀ the motor brakes.
///
/// Regions: 0 while the torque passes, 1 while it is clipped along the motion, −1 while it is clipped against it.
#[derive(Debug, Clone, Copy)]
pub struct SpeedTorqueLimit;

/// Returns the direction of motion; at rest either one will do, because both limits are then alike.
fn side<S>(moment: &Moment<S>) -> f64 {
    if moment.direction < 0.0 { -1.0 } else { 1.0 }
}

/// Returns the largest torque along the motion.
fn along<S: Scalar>(&[limit, speed, ..]: &Values<S>, moment: &Moment<S>) -> S {
    limit - limit * moment.velocity * side(moment) / speed
}

impl Law for SpeedTorqueLimit {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque(
        "min(max(drive - stiffness * (position - rest_angle) - damping * velocity, \
         -{torque} * min(1, 1 + velocity / {no_load_speed})), \
         {torque} * min(1, 1 - velocity / {no_load_speed})) \
         - (drive - stiffness * (position - rest_angle) - damping * velocity)",
    );
    const DIRECTED: bool = true;

    fn torque<S: Scalar>(values: &Values<S>, moment: &Moment<S>) -> S {
        let &[limit, ..] = values;
        match moment.region {
            0 => S::from(0.0),
            1 => along(values, moment) * side(moment) - moment.drive_torque(),
            _ => -limit * side(moment) - moment.drive_torque(),
        }
    }

    fn region(values: &Values<f64>, moment: &Moment<f64>) -> i8 {
        let &[limit, ..] = values;
        match moment.drive_torque() * side(moment) {
            above if above > along(values, moment) => 1,
            below if below < -limit => -1,
            _ => 0,
        }
    }

    fn margins<S: Scalar>(values: &Values<S>, moment: &Moment<S>) -> Margins<S> {
        let &[limit, ..] = values;
        let torque = moment.drive_torque() * side(moment);
        match moment.region {
            0 => [Some(along(values, moment) - torque), Some(limit + torque)],
            1 => [Some(torque - along(values, moment)), None],
            _ => [Some(-limit - torque), None],
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
