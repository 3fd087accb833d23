//! Models of a robot: whatever gives a mass matrix and bias forces.

use crate::error::RobotError;
use crate::repair::JointRepair;
use dynamics::tree::{Acting, JointMotion, Mechanism, State, Tree, rollout};

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
    /// Inertia of a rotor that the model's file states, in kg m² or kg; `None` where it can state none.
    pub armature: Option<f64>,
    /// Stiffness of a spring relaxed at 0 that the model's file states, in N m/rad or N/m; `None` where it can state none.
    pub stiffness: Option<f64>,
}

/// Source of a robot's mass matrix and bias forces: a URDF, or a simulator of the user's.
pub trait Model: Send + Sync {
    /// Returns the joints in the order of all vectors.
    fn joints(&self) -> &[JointInfo];

    /// Returns the name of the format of its file, at the beginning of a sentence.
    fn format(&self) -> &'static str;

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

    /// Computes mass matrices and bias forces at many states.
    ///
    /// # Errors
    /// [`RobotError::Model`].
    fn along(&self, states: &[State]) -> Result<Evaluated, RobotError> {
        let each = states
            .iter()
            .map(|own| Ok((self.mass_matrix(&own.position)?, self.bias(&own.position, &own.velocity)?)));
        let each: Vec<_> = each.collect::<Result<_, RobotError>>()?;
        Ok(each.into_iter().unzip())
    }

    /// Computes the motion under torques that change linearly between times in seconds, with what else acts in the joints. Returns
    /// the positions at each time.
    ///
    /// # Errors
    /// [`RobotError::Motion`] for a motion that leaves every bound; [`RobotError::Model`].
    fn rollout(
        &self,
        acting: &[Acting],
        start: &State,
        times: &[f64],
        torques: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, RobotError> {
        rollout(&Moving(self), acting, start, times, torques)
    }

    /// Returns the model with other numbers in its joints, one repair for each; `None` if it is no file.
    ///
    /// # Errors
    /// [`RobotError::Model`].
    fn repaired(&self, repairs: &[JointRepair]) -> Result<Option<RepairedModel>, RobotError> {
        let _ = repairs;
        Ok(None)
    }
}

/// Repaired model as a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RepairedModel {
    /// Ending of the file's name: `urdf` or `xml`.
    pub extension: &'static str,
    /// Text of the file.
    pub text: String,
}

/// Mass matrices and bias forces, by state.
pub type Evaluated = (Vec<Vec<Vec<f64>>>, Vec<Vec<f64>>);

/// Model as something that the integrator moves.
pub(crate) struct Moving<'a, M: ?Sized>(pub(crate) &'a M);

impl<M: Model + ?Sized> Mechanism for Moving<'_, M> {
    type Error = RobotError;

    fn names(&self) -> Vec<String> {
        self.0.joints().iter().map(|own| own.name.clone()).collect()
    }

    fn mass_matrix(&self, position: &[f64]) -> Result<Vec<Vec<f64>>, RobotError> {
        self.0.mass_matrix(position)
    }

    fn bias(&self, position: &[f64], velocity: &[f64]) -> Result<Vec<f64>, RobotError> {
        self.0.bias(position, velocity)
    }
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
            armature: None,
            stiffness: None,
        });
        Self { joints: joints.collect(), tree }
    }
}

impl Model for TreeModel {
    fn joints(&self) -> &[JointInfo] {
        &self.joints
    }

    fn format(&self) -> &'static str {
        "URDF"
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
