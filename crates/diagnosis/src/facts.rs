//! Scales of a record that bounds and grids of parameters are stated in.

/// Scales of the motion, from the records and the nominal simulator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Facts {
    /// Largest deflection, in rad or m.
    pub(crate) amplitude: f64,
    /// Largest and smallest position, in rad or m.
    pub(crate) highest: f64,
    pub(crate) lowest: f64,
    /// Largest speed.
    pub(crate) speed: f64,
    /// Angular frequency in rad/s; without a spring one over the time constant.
    pub(crate) frequency: f64,
    /// Largest torque of the spring, or of the inertia where there is none.
    pub(crate) torque: f64,
    /// Largest torque of the input; 0 without one.
    pub(crate) input_torque: f64,
    /// Length of the longest record in seconds.
    pub(crate) duration: f64,
    /// Median time between samples in seconds.
    pub(crate) interval: f64,
    /// Nominal inertia, stiffness (or what would give the frequency) and damping.
    pub(crate) inertia: f64,
    pub(crate) stiffness: f64,
}
