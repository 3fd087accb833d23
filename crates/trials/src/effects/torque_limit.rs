//! Torque limit: a servo whose whole torque is clipped.

use super::size::Shape;
use super::{EffectClass, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::Driven],
    needs_input: true,
    ..TrialEffect::new(Effect::System(SystemEffect::TorqueLimit), EffectClass::Actuator, Size::Solved(shape))
};

fn shape(situation: &Situation, _: &mut Draws) -> Shape {
    let largest = situation.largest_input() + situation.largest_torque();
    Shape::new(0.3, 0.95, move |size| vec![largest * (1.0 - size)])
}
