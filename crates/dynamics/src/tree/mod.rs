//! Trees of rigid bodies joined by revolute, prismatic and fixed joints: mass matrix, bias forces and motion.
//!
//! A [`Tree`] is built body by body, each after its parent. Angles are in rad, displacements in m, torques in
//! N m, forces in N. A continuous joint is a revolute one.
//!
//! # Reference
//! Featherstone, *Rigid Body Dynamics Algorithms* (2008), chapters 5 (recursive Newton–Euler) and 6 (composite
//! rigid body).

mod algorithms;
mod body;
mod error;
mod rollout;
mod structure;
#[cfg(test)]
mod tests;
mod vector;

pub use algorithms::solved;
pub use body::{Body, Inertia, JointMotion, Placement};
pub use error::TreeError;
pub use rollout::{Acting, Mechanism, State, rollout};
pub use structure::Tree;
