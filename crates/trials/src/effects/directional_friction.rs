//! Directional friction: dry friction that differs by direction.

use super::size::Shape;
use super::{EffectClass, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::Driven],
    needs_input: true,
    ..TrialEffect::new(
        Effect::System(SystemEffect::DirectionalFriction),
        EffectClass::Friction,
        Size::Solved(shape),
    )
};

fn shape(situation: &Situation, draws: &mut Draws) -> Shape {
    let (torque, difference) = (situation.largest_torque(), draws.sign() * draws.uniform(0.2, 1.0));
    Shape::new(1e-3, 0.1, move |size| vec![size * torque, difference * size * torque])
}
