//! The effects, one file each. The list that counts is [`crate::registry`].

mod asymmetric_stiffness;
mod backlash;
mod constant_torque;
mod coulomb_friction;
mod cubic_stiffness;
mod damping_drift;
mod end_stop;
mod flexible_coupling;
mod gravity;
mod hysteresis;
mod input_delay;
mod input_saturation;
mod periodic_forcing;
mod position_torque;
mod quadratic_drag;
mod smooth_torque;
mod stiffness_drift;
mod stribeck_friction;

pub use asymmetric_stiffness::AsymmetricStiffness;
pub use backlash::Backlash;
pub use constant_torque::ConstantTorque;
pub use coulomb_friction::CoulombFriction;
pub use cubic_stiffness::CubicStiffness;
pub use damping_drift::DampingDrift;
pub use end_stop::EndStop;
pub use flexible_coupling::FlexibleCoupling;
pub use gravity::Gravity;
pub use hysteresis::Hysteresis;
pub use input_delay::InputDelay;
pub use input_saturation::InputSaturation;
pub use periodic_forcing::PeriodicForcing;
pub use position_torque::PositionTorque;
pub use quadratic_drag::QuadraticDrag;
pub use smooth_torque::SmoothTorque;
pub use stiffness_drift::StiffnessDrift;
pub use stribeck_friction::StribeckFriction;
