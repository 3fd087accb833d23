//! Load-dependent friction: dry friction that grows with the torque of a servo's drive.

use super::size::Shape;
use super::{EffectClass, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::Driven],
    needs_input: true,
    ..TrialEffect::new(Effect::System(SystemEffect::LoadFriction), EffectClass::Friction, Size::Solved(shape))
};

fn shape(situation: &Situation, draws: &mut Draws) -> Shape {
    let torque = draws.uniform(0.0, 0.5) * situation.largest_torque();
    Shape::new(1e-3, 0.5, move |size| vec![size * torque, size])
}
