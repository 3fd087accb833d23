//! Effects that a simulator may lack, in the form that a diagnosis fits: one file for each effect.
//!
//! Everything that a diagnosis knows of an effect is in the effect's file, as its [`CandidateLaw`]: its
//! parameters and their bounds, the records on which it can act, the shapes at which it is tried, its
//! first-order changes, and the effects it is confused with. The rest of the crate uses a [`Candidate`] and
//! names no effect.
//!
//! # Adding an effect
//! The effect's law in `dynamics` (a file and its lines, see `dynamics::registry`) defines its dynamics. Here
//! it needs:
//!
//! 1. `candidates/NAME.rs`: a unit struct with a [`CandidateLaw`]. Required are the effect, its class, its
//!    parameters with bounds, and whether its coefficients have a sign;
//!    [`CubicStiffness`](cubic_stiffness::CubicStiffness) has these and nothing else. The defaults suit a
//!    torque that is smooth and linear in its one parameter: its columns are then the responses to the law's
//!    own torque. An effect with a shape also defines [`shapes`](CandidateLaw::shapes) and
//!    [`linear_places`](CandidateLaw::linear_places), as [`EndStop`](end_stop::EndStop) does. An effect whose
//!    fit parameters differ from the law's defines [`values`](CandidateLaw::values),
//!    [`fitted`](CandidateLaw::fitted) and [`slopes`](CandidateLaw::slopes), as
//!    [`StribeckFriction`](stribeck_friction::StribeckFriction) does.
//! 2. Its module below, and its line in [`REGISTRY`].
//!
//! An effect may have a second law that generalizes its first, as [`BoucWen`](bouc_wen::BoucWen) generalizes
//! [`Hysteresis`](hysteresis::Hysteresis). It is tried where the first leaves more than noise, and both count as the
//! same effect in the answer; [`stated`](CandidateLaw::stated) says which of the two fits given values.
//!
//! Search, evidence, intervals, shares of the gap and the repaired simulator follow. A test of the whole
//! program adds an effect in this way and diagnoses it.
//!
//! An effect of the measurement chain defines [`columns`](CandidateLaw::columns), and
//! [`read`](CandidateLaw::read) with [`sensor_derivative`](CandidateLaw::sensor_derivative). Its action on a
//! reading is in [`crate::model::sensor`], where all effects of a sensor are applied in their physical order.

mod along;
pub(crate) mod asymmetric_stiffness;
pub(crate) mod backlash;
pub(crate) mod bouc_wen;
pub(crate) mod clock_drift;
pub(crate) mod command_derivative;
pub(crate) mod constant_torque;
pub(crate) mod coulomb_friction;
pub(crate) mod cubic_stiffness;
pub(crate) mod damping_drift;
pub(crate) mod directional_friction;
pub(crate) mod drive_dead_band;
pub(crate) mod end_stop;
mod evidence_class;
pub(crate) mod flexible_coupling;
pub(crate) mod friction_drift;
pub(crate) mod gravity;
pub(crate) mod hysteresis;
pub(crate) mod input_delay;
pub(crate) mod input_saturation;
mod law;
pub(crate) mod load_friction;
mod main_mode;
mod parameter;
pub(crate) mod periodic_forcing;
mod polar;
mod position_torque;
pub(crate) mod quadratic_drag;
pub(crate) mod sensor_drift;
pub(crate) mod sensor_lag;
pub(crate) mod sensor_nonlinearity;
pub(crate) mod sensor_quantization;
pub(crate) mod sensor_saturation;
pub(crate) mod speed_torque_limit;
pub(crate) mod stiffness_drift;
pub(crate) mod stribeck_friction;
pub(crate) mod torque_limit;
mod unlisted_damping;
mod unlisted_stiffness;

use crate::model::candidate::Candidate;
pub(crate) use along::{Along, Lines, Mode, driven, padded};
pub(crate) use evidence_class::EvidenceClass;
pub(crate) use law::{CandidateLaw, grid, has_drive, secant};
pub(crate) use main_mode::MainMode;
pub(crate) use parameter::{Hidden, Parameter};
pub(crate) use polar::Polar;
pub(crate) use position_torque::PositionTorque;
pub(crate) use unlisted_damping::UnlistedDamping;
pub(crate) use unlisted_stiffness::UnlistedStiffness;

/// Every effect that a fit can name, in the order in which sets and answers list them.
pub(crate) const REGISTRY: &[Candidate] = &[
    Candidate::new(&coulomb_friction::CoulombFriction),
    Candidate::new(&stribeck_friction::StribeckFriction),
    Candidate::new(&quadratic_drag::QuadraticDrag),
    Candidate::new(&cubic_stiffness::CubicStiffness),
    Candidate::new(&asymmetric_stiffness::AsymmetricStiffness),
    Candidate::new(&gravity::Gravity),
    Candidate::new(&backlash::Backlash),
    Candidate::new(&hysteresis::Hysteresis),
    Candidate::new(&bouc_wen::BoucWen),
    Candidate::new(&end_stop::EndStop),
    Candidate::new(&stiffness_drift::StiffnessDrift),
    Candidate::new(&damping_drift::DampingDrift),
    Candidate::new(&periodic_forcing::PeriodicForcing),
    Candidate::new(&flexible_coupling::FlexibleCoupling),
    Candidate::new(&input_delay::InputDelay),
    Candidate::new(&input_saturation::InputSaturation),
    Candidate::new(&command_derivative::CommandDerivative),
    Candidate::new(&constant_torque::ConstantTorque),
    Candidate::new(&sensor_saturation::SensorSaturation),
    Candidate::new(&sensor_lag::SensorLag),
    Candidate::new(&sensor_nonlinearity::SensorNonlinearity),
    Candidate::new(&sensor_drift::SensorDrift),
    Candidate::new(&clock_drift::ClockDrift),
    Candidate::new(&sensor_quantization::SensorQuantization),
    Candidate::new(&torque_limit::TorqueLimit),
    Candidate::new(&load_friction::LoadFriction),
    Candidate::new(&directional_friction::DirectionalFriction),
    Candidate::new(&friction_drift::FrictionDrift),
    Candidate::new(&drive_dead_band::DriveDeadBand),
    Candidate::new(&speed_torque_limit::SpeedTorqueLimit),
];
