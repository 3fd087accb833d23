//! Alternative laws of effects of the vocabulary, one file each.

mod bouc_wen;
mod drag_power;
mod exponential_drift;
mod exponential_spring;
mod hertz_stop;
mod lugre;
mod rounded_backlash;
mod second_body;
mod sine_spring;
mod wandering_forcing;
mod weight;

pub(crate) use bouc_wen::BoucWen;
pub(crate) use drag_power::DragPower;
pub(crate) use exponential_drift::{Drifting, ExponentialDrift};
pub(crate) use exponential_spring::ExponentialSpring;
pub(crate) use hertz_stop::HertzStop;
pub(crate) use lugre::LuGre;
pub(crate) use rounded_backlash::RoundedBacklash;
pub(crate) use second_body::SecondBody;
pub(crate) use sine_spring::SineSpring;
pub(crate) use wandering_forcing::WanderingForcing;
pub(crate) use weight::Weight;
