//! Sensor drift: a zero that moves with time.

use super::size::Shape;
use super::{EffectClass, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::situation::Situation;
use dynamics::{ChainEffect, Effect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::LeftOut, Bank::Driven],
    ..TrialEffect::new(
        Effect::MeasuringChain(ChainEffect::SensorDrift),
        EffectClass::Sensor,
        Size::Solved(shape),
    )
};

fn shape(situation: &Situation, draws: &mut Draws) -> Shape {
    Shape::scaled(1e-4, 1.0, draws.sign() * situation.amplitude / situation.duration())
}
