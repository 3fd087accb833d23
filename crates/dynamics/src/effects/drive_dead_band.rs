//! Dead band of a servo.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Margins, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "drive_dead_band",
    title: "Dead band of the drive",
    kind: Kind::System,
    class: Class::TimeDependent,
    equation: "-k sat(e, ±w), where e = τ/k - (θ - θ_rest) is the drive's error: errors up to w give no torque",
    latex: r"-k\operatorname{sat}_w(e),\quad e=\tau/k-(\theta-\theta_\mathrm{rest})",
    parameters: &[Parameter {
        name: "half_width",
        symbol: "w",
        quantity: Quantity::Position,
        range: Range::POSITIVE,
        meaning: "error up to which the drive gives no proportional torque",
        default: None,
    }],
    tell_tale: "The body stops anywhere within ±w of the command, and small steps move it too little.",
    confused_with: &["coulomb_friction", "backlash"],
    reference: "Khalil, Nonlinear Systems, 3rd ed., Prentice Hall 2002, section 1.2",
    driven_only: true,
    hidden_states: 0,
    smooth: false,
    example: &[0.01],
};

/// Dead band of a servo: its error e = τ/k − (θ − θ_rest), command less position, gives a proportional torque only
/// beyond ±w, which adds −k·sat(e, ±w). The dead zone of [`Backlash`](super::Backlash) stays about the rest angle;
/// this one moves with the command.
///
/// Regions: 0 inside the dead band, ±1 beyond it.
#[derive(Debug, Clone, Copy)]
pub struct DriveDeadBand;

impl Law for DriveDeadBand {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque(
        "-min(max(drive - stiffness * (position - rest_angle), -stiffness * {half_width}), \
         stiffness * {half_width})",
    );

    fn torque<S: Scalar>(&[half_width, ..]: &Values<S>, moment: &Moment<S>) -> S {
        match moment.region {
            0 => -moment.proportional_torque(),
            side => -moment.nominal.stiffness * half_width * f64::from(side),
        }
    }

    fn region(&[half_width, ..]: &Values<f64>, moment: &Moment<f64>) -> i8 {
        let edge = moment.nominal.stiffness * half_width;
        match moment.proportional_torque() {
            above if above > edge => 1,
            below if below < -edge => -1,
            _ => 0,
        }
    }

    fn margins<S: Scalar>(&[half_width, ..]: &Values<S>, moment: &Moment<S>) -> Margins<S> {
        let (torque, edge) = (moment.proportional_torque(), moment.nominal.stiffness * half_width);
        match moment.region {
            0 => [Some(edge - torque), Some(edge + torque)],
            side => [Some(torque * f64::from(side) - edge), None],
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
