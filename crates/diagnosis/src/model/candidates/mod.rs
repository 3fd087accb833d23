//! What a simulator may lack, as a diagnosis fits it: one file for each effect.
//!
//! Everything that a diagnosis knows of an effect stands in the effect's file, as its [`CandidateLaw`]: what its parameters are
//! and how far they may go, on which records it can act, at which shapes it is tried and what it would change to
//! first order, what it is confused with. The rest of the crate asks a [`Candidate`] and names no effect.
//!
//! # Adding an effect
//! The effect's law, in `dynamics` (a file and its lines, see `dynamics::registry`), says what it does. Here it takes:
//!
//! 1. `candidates/NAME.rs`: a unit struct with a [`CandidateLaw`]. Required are the effect, its class, its parameters with
//!    bounds, and whether its coefficients have a sign; [`CubicStiffness`](cubic_stiffness::CubicStiffness) is the shortest.
//!    Defaults suit a torque that is smooth and linear in its one parameter. One with a further shape gives
//!    `shapes` and `linear_parameters`, one that is fitted in other numbers than its law's `values`, `fitted` and `slopes`.
//! 2. Its module below, and its line in [`REGISTRY`].
//!
//! Nothing else: search, evidence, intervals, shares of the gap and the repaired simulator follow.

mod along;
mod asymmetric_stiffness;
mod backlash;
mod clock_drift;
mod constant_torque;
mod coulomb_friction;
mod cubic_stiffness;
mod damping_drift;
mod end_stop;
mod evidence_class;
mod flexible_coupling;
mod gravity;
mod hysteresis;
mod input_delay;
mod input_saturation;
mod law;
mod main_mode;
mod parameter;
mod periodic_forcing;
mod polar;
mod position_torque;
mod quadratic_drag;
mod sensor_drift;
mod sensor_lag;
mod sensor_nonlinearity;
mod sensor_quantization;
mod sensor_saturation;
mod stiffness_drift;
mod stribeck_friction;

use crate::model::candidate::Candidate;
pub(crate) use along::{Along, Lines, Mode, held};
pub(crate) use asymmetric_stiffness::AsymmetricStiffness;
pub(crate) use backlash::Backlash;
pub(crate) use clock_drift::ClockDrift;
pub(crate) use constant_torque::ConstantTorque;
pub(crate) use coulomb_friction::CoulombFriction;
pub(crate) use cubic_stiffness::CubicStiffness;
pub(crate) use damping_drift::DampingDrift;
pub(crate) use end_stop::EndStop;
pub(crate) use evidence_class::EvidenceClass;
pub(crate) use flexible_coupling::FlexibleCoupling;
pub(crate) use gravity::Gravity;
pub(crate) use hysteresis::Hysteresis;
pub(crate) use input_delay::InputDelay;
pub(crate) use input_saturation::InputSaturation;
pub(crate) use law::{CandidateLaw, grid, padded, secant};
pub(crate) use main_mode::MainMode;
pub(crate) use parameter::Parameter;
pub(crate) use periodic_forcing::PeriodicForcing;
pub(crate) use polar::Polar;
pub(crate) use position_torque::PositionTorque;
pub(crate) use quadratic_drag::QuadraticDrag;
pub(crate) use sensor_drift::SensorDrift;
pub(crate) use sensor_lag::SensorLag;
pub(crate) use sensor_nonlinearity::SensorNonlinearity;
pub(crate) use sensor_quantization::SensorQuantization;
pub(crate) use sensor_saturation::SensorSaturation;
pub(crate) use stiffness_drift::StiffnessDrift;
pub(crate) use stribeck_friction::StribeckFriction;

/// Every effect that can be named by a fit, in the order in which sets and answers list them.
pub(crate) const REGISTRY: &[Candidate] = &[
    Candidate::new(&CoulombFriction),
    Candidate::new(&StribeckFriction),
    Candidate::new(&QuadraticDrag),
    Candidate::new(&CubicStiffness),
    Candidate::new(&AsymmetricStiffness),
    Candidate::new(&Gravity),
    Candidate::new(&Backlash),
    Candidate::new(&Hysteresis),
    Candidate::new(&EndStop),
    Candidate::new(&StiffnessDrift),
    Candidate::new(&DampingDrift),
    Candidate::new(&PeriodicForcing),
    Candidate::new(&FlexibleCoupling),
    Candidate::new(&InputDelay),
    Candidate::new(&InputSaturation),
    Candidate::new(&ConstantTorque),
    Candidate::new(&SensorSaturation),
    Candidate::new(&SensorLag),
    Candidate::new(&SensorNonlinearity),
    Candidate::new(&SensorDrift),
    Candidate::new(&ClockDrift),
    Candidate::new(&SensorQuantization),
];
