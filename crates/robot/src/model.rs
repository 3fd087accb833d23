//! Models of a robot: whatever gives a mass matrix and bias forces.

use crate::error::RobotError;
use dynamics::tree::{JointMotion, Tree};

/// Joint of a model as the diagnosis reads it.
#[derive(Debug, Clone, PartialEq)]
pub struct JointInfo {
    /// Name of the joint.
    pub name: String,
    /// `true` for a prismatic joint: its coordinate is a displacement in m.
    pub slides: bool,
    /// Viscous damping that the model has, in N m s/rad or N s/m.
    pub damping: f64,
    /// Dry friction that the model has, in N m or N.
    pub friction: f64,
}

/// Source of a robot's mass matrix and bias forces: a URDF, or a simulator of the user's.
pub trait Model: Sync {
    /// Returns the joints in the order of all vectors.
    fn joints(&self) -> &[JointInfo];

    /// Computes the rows of the mass matrix in kg m² (kg for prismatic joints), armatures included.
    ///
    /// # Errors
    /// [`RobotError::Model`].
    fn mass_matrix(&self, position: &[f64]) -> Result<Vec<Vec<f64>>, RobotError>;

    /// Computes the torques of gravity, Coriolis and centrifugal forces in N m, without damping and friction.
    ///
    /// # Errors
    /// [`RobotError::Model`].
    fn bias(&self, position: &[f64], velocity: &[f64]) -> Result<Vec<f64>, RobotError>;
}

/// Tree whose joints have damping and friction.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TreeModel {
    pub(crate) tree: Tree,
    pub(crate) joints: Vec<JointInfo>,
}

impl TreeModel {
    /// Creates the model from the damping and friction of each joint that moves.
    pub(crate) fn new(tree: Tree, dissipation: &[(f64, f64)]) -> Self {
        let joints = tree.moving().zip(dissipation).map(|(body, &(damping, friction))| JointInfo {
            name: body.name.clone(),
            slides: matches!(body.motion, JointMotion::Prismatic(_)),
            damping,
            friction,
        });
        Self { joints: joints.collect(), tree }
    }
}

impl Model for TreeModel {
    fn joints(&self) -> &[JointInfo] {
        &self.joints
    }

    fn mass_matrix(&self, position: &[f64]) -> Result<Vec<Vec<f64>>, RobotError> {
        let failed = |error: dynamics::tree::TreeError| RobotError::Model {
            quantity: "mass matrix",
            problem: error.to_string(),
        };
        self.tree.mass_matrix(position).map_err(failed)
    }

    fn bias(&self, position: &[f64], velocity: &[f64]) -> Result<Vec<f64>, RobotError> {
        let failed = |error: dynamics::tree::TreeError| RobotError::Model {
            quantity: "bias forces",
            problem: error.to_string(),
        };
        self.tree.bias(position, velocity).map_err(failed)
    }
}
