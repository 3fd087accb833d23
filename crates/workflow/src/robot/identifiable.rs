//! Quantities of a joint that recordings tell, and what would tell the others.

use super::joint::JointAnswer;
use results::{IdentifiableRow, WithInterval};

/// Half of an interval relative to the joint's inertia, up to which the inertia is told.
const INERTIA_TOLD: f64 = 0.1;

/// Half of an interval relative to the drive's root mean square, as the torque that the number makes in the motion, up to which
/// it is told.
const TORQUE_TOLD: f64 = 0.1;

/// Share of dry friction's motion that no other law imitates, from which dry friction is told from the rest: that of a motion
/// along one sine is 0.001.
const FRICTION_TOLD: f64 = 0.01;

fn is_within(own: Option<WithInterval>, bound: f64) -> bool {
    own.is_some_and(|own| 0.5 * (own.interval_95[1] - own.interval_95[0]) <= bound)
}

/// Lists what the recordings tell of a joint.
pub(super) fn identifiable(own: &JointAnswer) -> Vec<IdentifiableRow> {
    let scale = own.scale;
    let rows = [
        (
            "armature",
            is_within(own.repair.armature, INERTIA_TOLD * own.tracking.inertia),
            "faster turns of this joint: the torque that accelerates it must stand out beside that of its weight",
        ),
        (
            "damping",
            is_within(own.repair.damping, TORQUE_TOLD * scale.torque / scale.speed.max(f64::MIN_POSITIVE)),
            "motion of this joint at several speeds, the fastest as fast as it may go",
        ),
        (
            "dry_friction",
            scale.friction_alone >= FRICTION_TOLD,
            "sums of several sines for this joint, such as 0.3, 0.7 and 1.3 Hz: along one sine, dry and viscous friction \
             take as much energy",
        ),
        (
            "torque_offset",
            is_within(own.repair.torque_offset, TORQUE_TOLD * scale.torque),
            "motion of this joint in both directions, several times",
        ),
    ];
    let row = |(quantity, told, record): (&str, bool, &str)| IdentifiableRow {
        quantity: quantity.to_owned(),
        joint: own.joint.name.clone(),
        told,
        record: if told { String::new() } else { record.to_owned() },
    };
    rows.into_iter().map(row).collect()
}
