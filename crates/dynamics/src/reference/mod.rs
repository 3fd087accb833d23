//! Reference integrator: high order, events located to rounding, exact sticking.
//!
//! Smooth pieces are integrated by Gauss–Legendre collocation of high order (12 stages: the end of a step is
//! of order 24). The step size is chosen from the tail of the Legendre series of the rates. Every edge of a
//! piece (reversal of the velocity, dead zone, contact, saturation, knots of the input, break-away) is
//! located on the collocation polynomial. The step is then solved again so that it ends there, until the edge
//! is met to rounding. Dry friction is a set-valued force: at a reversal the system sticks if the torque does
//! not exceed the holding torque. Hidden states and time-dependent torques continue meanwhile and may break
//! it loose. Nothing is smoothed.
//!
//! # Why not a library
//! The crates that offer ordinary differential equations with dense output (`differential-equations`,
//! `ode_solvers`, `diffsol`) locate events on an interpolant of order at most 7 and restart from there, which
//! costs five digits at a tolerance of 1e-12. None offers quadratures with the order of the step. Collocation
//! provides the interpolant, the quadratures of the energy accounts and exact landing from one set of tables,
//! computed in `gauss.rs`.
//!
//! # Example
//! Dry friction stops a swing; the work of damping and friction equals the energy that the swing had:
//!
//! ```
//! use dynamics::reference::{Happening, Tolerance, simulate};
//! use dynamics::{Active, Nominal, Start, System};
//!
//! let friction = Active::named("coulomb_friction", &[("torque", 20.0)])?;
//! let system = System::new(Nominal::new(1.0, 0.3, 484.0, 0.0)?, vec![friction])?;
//! let times = [0.0, 1.0, 5.0];
//! let motion = simulate(&system, Start::release(0.5), None, &times, &Tolerance::default())?;
//!
//! let at_rest = motion.events.iter().find(|event| event.happening == Happening::Stick);
//! assert!(at_rest.is_some_and(|event| event.time < 5.0 && event.velocity == 0.0));
//! let energy = |at: usize| 0.5 * motion.velocity[at].powi(2) + 0.5 * 484.0 * motion.position[at].powi(2);
//! let work: f64 = motion.accounts.iter().map(|account| account.work[2]).sum();
//! assert!((energy(2) - energy(0) - work).abs() < 1e-9, "the accounts are complete");
//! # Ok::<(), dynamics::DynamicsError>(())
//! ```

mod gauss;
mod landing;
mod motion;
mod recorder;
mod run;
mod step;
mod tolerance;

pub use motion::{Account, Event, Happening, Motion, Worker};
pub use tolerance::Tolerance;

use crate::error::DynamicsError;
use crate::input::Input;
use crate::system::{Start, System};

/// Computes the motion of a system from a start at the first of `times`.
///
/// `times` are in seconds and never decrease; drifts, forcing and input count the same time. With `None` for
/// the input it is a free motion. Effects with hidden state start relaxed and moving along.
///
/// # Errors
/// Returns [`DynamicsError::BadTimes`], [`DynamicsError::BadStart`],
/// [`DynamicsError::ReleaseInsideDeadZone`], [`DynamicsError::Diverged`] if the motion diverges, and
/// [`DynamicsError::StepTooSmall`] or [`DynamicsError::TooManySteps`] if the tolerance is out of reach.
pub fn simulate(
    system: &System,
    start: Start,
    input: Option<&Input>,
    times: &[f64],
    tolerance: &Tolerance,
) -> Result<Motion, DynamicsError> {
    if input.is_none() {
        system.check_release(start)?;
    }
    run::Run::new(system, start, input, times, run::Stepping::Adaptive(*tolerance), STAGES)?.motion(times)
}

/// Number of stages of the collocation. More stages take fewer but costlier steps; 12 are near the least work
/// at 1e-12.
const STAGES: usize = 12;

#[cfg(test)]
mod tests;
