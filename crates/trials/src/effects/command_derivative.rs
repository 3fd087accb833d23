//! Command derivative: a command whose rate acts beside it.

use super::size::Shape;
use super::{EffectClass, Size, TrialEffect};
use crate::hidden::Bank;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::Driven],
    needs_input: true,
    ..TrialEffect::new(
        Effect::System(SystemEffect::CommandDerivative),
        EffectClass::Actuator,
        Size::Solved(|situation, _| Shape::scaled(1e-2, 3.0, 1.0 / situation.omega())),
    )
};
