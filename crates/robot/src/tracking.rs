//! Spring and damper that hold a simulator of one joint to its measured motion.

/// Spring and damper that hold a simulator of one joint to its measured motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracking {
    /// Mean of the joint's own entry of the mass matrix, in kg m² or kg.
    pub inertia: f64,
    /// Damping in N m s/rad or N s/m.
    pub damping: f64,
    /// Stiffness in N m/rad or N/m.
    pub stiffness: f64,
}
