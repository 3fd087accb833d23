//! Errors of a tree, and its checks.

use super::body::{Body, Inertia, JointMotion, Placement};
use thiserror::Error;

/// Reason why bodies form no tree, or why values do not fit it.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TreeError {
    /// A body comes before its parent.
    #[error("joint `{joint}` names body {parent} as parent, which does not come before it")]
    Parent {
        /// Name of the joint.
        joint: String,
        /// Index of the parent.
        parent: usize,
    },
    /// The axis of a joint has no direction.
    #[error("joint `{joint}` has the axis {axis:?}, which has no direction; state one such as 0 0 1")]
    Axis {
        /// Name of the joint.
        joint: String,
        /// Axis as given.
        axis: [f64; 3],
    },
    /// A number is out of range.
    #[error(
        "joint `{joint}`: {quantity} is {value}; expected a finite number, 0 or above for a mass, moment or armature"
    )]
    Number {
        /// Name of the joint.
        joint: String,
        /// Name of the quantity.
        quantity: &'static str,
        /// Value as given.
        value: f64,
    },
    /// No joint moves.
    #[error(
        "every joint is fixed, so nothing moves; expected at least one revolute, continuous or prismatic joint"
    )]
    NoJoint,
    /// A joint moves no inertia.
    #[error(
        "joint `{joint}` moves no inertia: the links beyond it have neither mass nor moment of inertia; state their \
         <inertial>"
    )]
    NoInertia {
        /// Name of the joint.
        joint: String,
    },
    /// The number of values is not that of the joints.
    #[error("{found} values for {expected} joints")]
    Length {
        /// Number of joints that move.
        expected: usize,
        /// Number of values given.
        found: usize,
    },
    /// A motion left every bound.
    #[error("the motion of the model leaves every bound after {time_s:.3} s")]
    Diverged {
        /// Time in seconds.
        time_s: f64,
    },
}

/// Returns a value that is finite and not negative.
pub(super) fn not_negative(joint: &str, quantity: &'static str, value: f64) -> Result<f64, TreeError> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(TreeError::Number { joint: joint.to_owned(), quantity, value })
    }
}

/// Checks a body and scales its axis to unit length.
pub(super) fn checked(index: usize, body: Body) -> Result<Body, TreeError> {
    let joint = &body.name;
    if let Some(parent) = body.parent.filter(|parent| *parent >= index) {
        return Err(TreeError::Parent { joint: joint.clone(), parent });
    }
    not_negative(joint, "mass", body.inertia.mass)?;
    not_negative(joint, "armature", body.armature)?;
    let Inertia { center, moments, .. } = body.inertia;
    let Placement { origin, rotation } = body.placement;
    for (quantity, values) in [
        ("center of mass", vec![center]),
        ("moment of inertia", moments.to_vec()),
        ("origin", vec![origin]),
        ("rotation", rotation.to_vec()),
    ] {
        if let Some(&value) = values.iter().flatten().find(|value| !value.is_finite()) {
            return Err(TreeError::Number { joint: joint.clone(), quantity, value });
        }
    }
    let [[xx, ..], [_, yy, _], [_, _, zz]] = moments;
    for value in [xx, yy, zz] {
        not_negative(joint, "moment of inertia", value)?;
    }
    let unit = |axis: [f64; 3]| {
        let length = axis.iter().map(|own| own * own).sum::<f64>().sqrt();
        if length.is_finite() && length > 0.0 {
            Ok(axis.map(|own| own / length))
        } else {
            Err(TreeError::Axis { joint: joint.clone(), axis })
        }
    };
    let motion = match body.motion {
        JointMotion::Fixed => JointMotion::Fixed,
        JointMotion::Revolute(axis) => JointMotion::Revolute(unit(axis)?),
        JointMotion::Prismatic(axis) => JointMotion::Prismatic(unit(axis)?),
    };
    Ok(Body { motion, ..body })
}
