//! Torques by laws that [`dynamics`] does not have: one law, one file.

mod bouc_wen;
mod cogging;
mod drag_power;
mod exponential_drift;
mod exponential_spring;
mod field;
mod hertz_stop;
mod lugre;
mod maxwell;
mod parametric;
mod position_damping;
mod rounded_backlash;
mod second_body;
mod sine_spring;
mod wandering_forcing;
mod weight;

pub(crate) use bouc_wen::BoucWen;
pub(crate) use cogging::Cogging;
pub(crate) use drag_power::DragPower;
pub(crate) use exponential_drift::{Drifting, ExponentialDrift};
pub(crate) use exponential_spring::ExponentialSpring;
pub(crate) use field::Field;
pub(crate) use hertz_stop::HertzStop;
pub(crate) use lugre::LuGre;
pub(crate) use maxwell::Maxwell;
pub(crate) use parametric::Parametric;
pub(crate) use position_damping::PositionDamping;
pub(crate) use rounded_backlash::RoundedBacklash;
pub(crate) use second_body::SecondBody;
pub(crate) use sine_spring::SineSpring;
pub(crate) use wandering_forcing::WanderingForcing;
pub(crate) use weight::Weight;
