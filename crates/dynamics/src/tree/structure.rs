//! Tree of bodies.

use super::body::{Body, JointMotion};
use super::error::{self, TreeError};

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
    pub(super) bodies: Vec<Body>,
    pub(super) gravity: [f64; 3],
}

/// Gravity of a tree in m/s², downward along z, unless stated otherwise.
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

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

    pub(super) fn check<T>(&self, values: &[T]) -> Result<(), TreeError> {
        let expected = self.joints();
        if values.len() == expected {
            Ok(())
        } else {
            Err(TreeError::Length { expected, found: values.len() })
        }
    }
}
