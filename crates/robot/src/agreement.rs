//! Coefficients of a joint in one recording, to first order: do recordings agree?
//!
//! The torques that the model leaves unexplained move the joint's oscillator, and so does each law. Coefficients follow by
//! least squares, with errors from what is left, of which there are as many independent numbers as the oscillator's noise
//! bandwidth has in the length of the recording.

use crate::along::Along;
use crate::drive_noise::{Sample, directions, fitted, independent, moved, squares_left};
use crate::error::RobotError;
use crate::model::JointInfo;
use crate::projection::Gathered;

/// Coefficient of a joint in one recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointCoefficient {
    /// Quantity: `dry_friction`, `damping`, `armature` or `stiffness`.
    pub quantity: &'static str,
    /// Value, in SI units.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

/// Names of the quantities, in the order of the columns.
const QUANTITIES: [&str; 4] = ["dry_friction", "damping", "armature", "stiffness"];

/// Estimates dry friction, damping, armature and stiffness of a joint from one recording, all at once.
///
/// # Errors
/// [`RobotError::NoColumn`] without a torque of the joint; [`RobotError::Still`] for a joint that does not move.
pub fn coefficients(
    joints: &[JointInfo],
    along: &Along,
    joint: usize,
) -> Result<Vec<JointCoefficient>, RobotError> {
    let gathered = Gathered::of(joints, &[along], joint, 1.0)?;
    let (_, recordings, _) = gathered.best();
    let samples: Vec<Sample> = recordings.into_iter().flatten().collect();
    let tracking = gathered.tracking;
    let times: Vec<f64> = samples.iter().map(|own| own.time).collect();
    let along_motion = |torques: Vec<f64>| -> Vec<f64> { moved(&tracking, &times, &torques, [0.0; 2]) };
    let column = |of: &dyn Fn(&Sample) -> f64| along_motion(samples.iter().map(of).collect());
    let none = vec![0.0; times.len()];
    let columns = vec![
        along_motion(directions(&samples)),
        column(&|own| own.velocity),
        column(&|own| own.acceleration),
        column(&|own| own.position),
        along_motion(vec![1.0; times.len()]),
        moved(&tracking, &times, &none, [1.0, 0.0]),
        moved(&tracking, &times, &none, [0.0, 1.0]),
    ];
    let target = column(&|own| own.unexplained);
    let found = fitted(&columns, &target);
    let left = squares_left(&columns, &found, target);
    let seconds = times.last().zip(times.first()).map_or(0.0, |(last, first)| last - first);
    let numbers = (independent(&tracking, seconds) - columns.len() as f64).max(1.0);
    let estimates = QUANTITIES.into_iter().zip(&found).enumerate().map(|(at, (quantity, found))| {
        let others: Vec<Vec<f64>> = columns
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != at)
            .map(|(_, own)| own.clone())
            .collect();
        // The squares of a column that the others do not imitate determine its coefficient.
        let own = columns.get(at).cloned().unwrap_or_default();
        let alone = squares_left(&others, &fitted(&others, &own), own);
        let error = (left / numbers / alone.max(f64::MIN_POSITIVE)).sqrt();
        // What is unexplained is what the joint needs less: a torque against the motion has its sign turned.
        JointCoefficient { quantity, value: -found, error }
    });
    Ok(estimates.collect())
}
