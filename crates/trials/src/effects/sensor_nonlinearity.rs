//! Sensor nonlinearity: an eccentric encoder magnet.

use super::size::Shape;
use super::{EffectClass, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::situation::Situation;
use dynamics::{ChainEffect, Effect};
use std::f64::consts::PI;

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::LeftOut, Bank::Releases, Bank::Measured, Bank::Driven],
    ..TrialEffect::new(
        Effect::MeasuringChain(ChainEffect::SensorNonlinearity),
        EffectClass::Sensor,
        Size::Solved(shape),
    )
};

fn shape(_: &Situation, draws: &mut Draws) -> Shape {
    let phase = draws.uniform(-PI, PI);
    Shape::new(1e-3, 0.3, move |size| vec![size, phase])
}
