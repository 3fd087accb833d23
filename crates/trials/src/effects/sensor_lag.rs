//! Sensor lag: a sensor that follows late.

use super::size::Shape;
use super::{EffectClass, Size, TrialEffect};
use crate::hidden::Bank;
use dynamics::{ChainEffect, Effect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::Driven],
    needs_input: true,
    ..TrialEffect::new(
        Effect::MeasuringChain(ChainEffect::SensorLag),
        EffectClass::Sensor,
        Size::Solved(|situation, _| Shape::scaled(1e-2, 3.0, 1.0 / situation.omega())),
    )
};
