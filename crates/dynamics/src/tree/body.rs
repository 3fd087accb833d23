//! Bodies, their joints and their inertia.

use super::vector::{Rows, product, rotation, transposed};

/// Motion that a joint allows; axes are unit vectors in the body's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointMotion {
    /// No motion.
    Fixed,
    /// Rotation about an axis.
    Revolute([f64; 3]),
    /// Displacement along an axis.
    Prismatic([f64; 3]),
}

/// Position and orientation of a frame in another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Origin, in m.
    pub origin: [f64; 3],
    /// Rows of the rotation matrix: the columns are the axes of the frame.
    pub rotation: [[f64; 3]; 3],
}

/// Inertia of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertia {
    /// Mass in kg, 0 or above.
    pub mass: f64,
    /// Center of mass in the body's frame, in m.
    pub center: [f64; 3],
    /// Moments about the center of mass along the axes of the body's frame, in kg m²; symmetric.
    pub moments: [[f64; 3]; 3],
}

/// Body of a tree and the joint that it moves by.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name of the joint.
    pub name: String,
    /// Index of the parent body; `None` for the ground.
    pub parent: Option<usize>,
    /// Frame of the body in that of its parent with the joint at 0.
    pub placement: Placement,
    /// Motion of the joint.
    pub motion: JointMotion,
    /// Inertia of the body.
    pub inertia: Inertia,
    /// Inertia of the rotor as seen at the joint, in kg m² (kg for a prismatic joint): that of the rotor times the
    /// square of the gear ratio. 0 or above.
    pub armature: f64,
}

impl Default for Placement {
    fn default() -> Self {
        Self { origin: [0.0; 3], rotation: IDENTITY }
    }
}

const IDENTITY: Rows<f64> = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Placement {
    /// Creates the placement of a frame by its origin in m and by rotations in rad about the fixed axes x, y and z,
    /// in this order (roll, pitch and yaw).
    #[must_use]
    pub fn from_roll_pitch_yaw(origin: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Self {
        let [about_x, about_y, about_z] = [
            rotation([1.0, 0.0, 0.0], roll),
            rotation([0.0, 1.0, 0.0], pitch),
            rotation([0.0, 0.0, 1.0], yaw),
        ];
        Self { origin, rotation: product(&about_z, &product(&about_y, &about_x)) }
    }

    /// Returns moments along the axes of this frame as moments along those of the frame that it is placed in.
    #[must_use]
    pub fn moments(&self, moments: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
        product(&self.rotation, &product(moments, &transposed(&self.rotation)))
    }
}
