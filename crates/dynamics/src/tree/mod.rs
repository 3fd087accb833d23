//! Trees of rigid bodies joined by revolute, prismatic and fixed joints: mass matrix, bias forces and motion.
//!
//! A [`Tree`] is built body by body, each after its parent. Angles are in rad, displacements in m, torques in
//! N m, forces in N. A continuous joint is a revolute one.
//!
//! # Reference
//! Featherstone, *Rigid Body Dynamics Algorithms* (2008), chapters 5 (recursive Newton–Euler) and 6 (composite
//! rigid body).

mod algorithms;
mod error;
mod rollout;
#[cfg(test)]
mod tests;
mod vector;

pub use algorithms::solved;
pub use error::TreeError;
pub use rollout::{Acting, State, rollout};

use vector::{Rows, product, rotation, transposed};

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

/// Tree of rigid bodies.
///
/// ```
/// use dynamics::tree::{Body, Inertia, JointMotion, Placement, Tree};
/// // A rod of 0.5 kg whose center hangs 0.2 m below its hinge.
/// let inertia = Inertia { mass: 0.5, center: [0.0, 0.0, -0.2], moments: [[0.0; 3]; 3] };
/// let rod = Body {
///     name: "hinge".into(),
///     parent: None,
///     placement: Placement::default(),
///     motion: JointMotion::Revolute([0.0, 1.0, 0.0]),
///     inertia,
///     armature: 0.003,
/// };
/// let tree = Tree::new(vec![rod])?;
/// assert!((tree.mass_matrix(&[0.3])?[0][0] - (0.5 * 0.04 + 0.003)).abs() < 1e-15);
/// let weight = 0.5 * 9.81 * 0.2 * 0.3_f64.sin();
/// assert!((tree.bias(&[0.3], &[0.0])?[0] - weight).abs() < 1e-15);
/// # Ok::<(), dynamics::tree::TreeError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Tree {
    bodies: Vec<Body>,
    gravity: [f64; 3],
}

impl Default for Placement {
    fn default() -> Self {
        Self { origin: [0.0; 3], rotation: IDENTITY }
    }
}

const IDENTITY: Rows<f64> = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Gravity of a tree in m/s², downward along z, unless stated otherwise.
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

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

impl Tree {
    /// Creates a tree from its bodies, each after its parent, under a gravity of 9.81 m/s² against z. Axes are
    /// scaled to unit length.
    ///
    /// # Errors
    /// [`TreeError`] for a parent that does not come before its body, an axis of length 0, a number that is not
    /// finite or negative where it must not be, a tree without a joint that moves, and a joint that moves no
    /// inertia.
    pub fn new(bodies: Vec<Body>) -> Result<Self, TreeError> {
        let mut checked = Vec::with_capacity(bodies.len());
        for (index, body) in bodies.into_iter().enumerate() {
            checked.push(error::checked(index, body)?);
        }
        let tree = Self { bodies: checked, gravity: GRAVITY };
        if tree.joints() == 0 {
            return Err(TreeError::NoJoint);
        }
        let diagonal = tree.mass_matrix(&vec![0.0; tree.joints()])?;
        for (at, (row, name)) in diagonal.iter().zip(tree.names()).enumerate() {
            if row.get(at).is_none_or(|own| *own <= 0.0) {
                return Err(TreeError::NoInertia { joint: name.to_owned() });
            }
        }
        Ok(tree)
    }

    /// Returns the tree under another gravity, in m/s².
    #[must_use]
    pub fn with_gravity(self, gravity: [f64; 3]) -> Self {
        Self { gravity, ..self }
    }

    /// Returns the tree with other armatures, in the order of [`Self::names`].
    ///
    /// # Errors
    /// [`TreeError::Length`] for another number of values, [`TreeError::Number`] for one below 0.
    pub fn with_armatures(mut self, armatures: &[f64]) -> Result<Self, TreeError> {
        self.check(armatures)?;
        let mut values = armatures.iter();
        for body in self.bodies.iter_mut().filter(|body| body.motion != JointMotion::Fixed) {
            if let Some(&armature) = values.next() {
                body.armature = error::not_negative(&body.name, "armature", armature)?;
            }
        }
        Ok(self)
    }

    /// Returns the bodies, each after its parent.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// Returns the number of joints that move.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.moving().count()
    }

    /// Returns the names of the joints that move, in the order of all vectors and matrices.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.moving().map(|body| body.name.as_str())
    }

    /// Returns the bodies whose joint moves.
    pub fn moving(&self) -> impl Iterator<Item = &Body> {
        self.bodies.iter().filter(|body| body.motion != JointMotion::Fixed)
    }

    fn check<T>(&self, values: &[T]) -> Result<(), TreeError> {
        let expected = self.joints();
        if values.len() == expected {
            Ok(())
        } else {
            Err(TreeError::Length { expected, found: values.len() })
        }
    }
}
