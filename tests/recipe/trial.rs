//! Damping that grows away from the middle.

use super::size::Shape;
use super::{EffectClass, Size, TrialEffect};
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect::new(
    Effect::System(SystemEffect::SineDrag),
    EffectClass::Damping,
    Size::Solved(|situation, _| Shape::scaled(1e-2, 100.0, situation.nominal.damping())),
);
