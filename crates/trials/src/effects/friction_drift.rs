//! Friction drift: dry friction that falls as a joint warms, or grows.

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
        Effect::System(SystemEffect::FrictionDrift),
        EffectClass::Friction,
        Size::Solved(shape),
    )
};

fn shape(situation: &Situation, draws: &mut Draws) -> Shape {
    let rate = draws.sign() * draws.uniform(0.7, 2.0) / situation.duration();
    let torque = situation.largest_torque();
    Shape::new(1e-3, 0.1, move |size| vec![size * torque, rate])
}
