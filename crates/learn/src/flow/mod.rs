//! Models that are differential equations, θ̈ = a(θ, θ̇, direction, u): integration with exact events and
//! sensitivities, initial states, and fits by multiple shooting.

mod field;
mod model;
mod run;
mod shooter;
mod shooting;
mod start;

pub use field::{Field, Slope};
pub use model::{FlowModel, Posterior, Running};
pub use run::{Motion, Run};
pub use shooter::FieldShooter;
pub use shooting::{Fit, LENGTHS, Penalty, Shooter, Shooting, Shot, fit, longest_as_good, phase_name};
pub use start::{State, first_guess};
