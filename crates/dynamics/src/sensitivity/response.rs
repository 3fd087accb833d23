//! Response of a run: motion and sensitivities.

use crate::field::SYSTEM_HIDDEN;

/// Full state at the start or at the end of a run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FullState {
    /// Position in rad or m.
    pub position: f64,
    /// Velocity in rad/s or m/s.
    pub velocity: f64,
    /// Hidden state variables in the order of the system's effects; at a start, `None` means relaxed and
    /// moving along.
    pub hidden: Option<[f64; SYSTEM_HIDDEN]>,
}

impl From<crate::Start> for FullState {
    fn from(start: crate::Start) -> Self {
        Self { position: start.position, velocity: start.velocity, hidden: None }
    }
}

/// Motion at the sample times, with its derivatives. Buffers are reused from run to run.
///
/// Sensitivities are row-major: one row per sample and one column per free quantity, in the order given to
/// the model.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Response {
    /// Positions in rad or m.
    pub position: Vec<f64>,
    /// Velocities in rad/s or m/s; empty unless requested.
    pub velocity: Vec<f64>,
    /// Accelerations in rad/s² or m/s²; empty unless requested.
    pub acceleration: Vec<f64>,
    /// Number of columns.
    pub columns: usize,
    /// ∂position/∂free, samples × columns.
    pub position_sensitivity: Vec<f64>,
    /// ∂velocity/∂free, samples × columns; empty unless both are requested.
    pub velocity_sensitivity: Vec<f64>,
    /// ∂acceleration/∂free, samples × columns; empty unless both are requested.
    pub acceleration_sensitivity: Vec<f64>,
    /// State at the last sample, hidden states included.
    pub end: FullState,
    /// ∂end/∂free, state variables (position, velocity, hidden …) × columns.
    pub end_sensitivity: Vec<f64>,
    /// Number of steps taken.
    pub steps: usize,
    /// Number of events located.
    pub events: usize,
}

impl Response {
    /// Returns the position sensitivities of a sample: one entry per free quantity; empty beyond the last
    /// sample.
    #[must_use]
    pub fn position_row(&self, sample: usize) -> &[f64] {
        let from = sample * self.columns;
        self.position_sensitivity.get(from..from + self.columns).unwrap_or(&[])
    }
}
