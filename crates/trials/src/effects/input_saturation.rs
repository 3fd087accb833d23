//! Input saturation: an input that is clipped.

use super::size::Shape;
use super::{EffectClass, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::LeftOut, Bank::Driven],
    needs_input: true,
    ..TrialEffect::new(
        Effect::System(SystemEffect::InputSaturation),
        EffectClass::Actuator,
        Size::Solved(shape),
    )
};

fn shape(situation: &Situation, _: &mut Draws) -> Shape {
    let largest = situation.largest_input();
    Shape::new(1e-2, 0.95, move |size| vec![largest * (1.0 - size)])
}
