//! Speed-dependent torque limit: a servo whose torque falls with its speed.

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
        Effect::System(SystemEffect::SpeedTorqueLimit),
        EffectClass::Actuator,
        Size::Solved(shape),
    )
};

fn shape(situation: &Situation, draws: &mut Draws) -> Shape {
    let largest = situation.largest_input() + situation.largest_torque();
    let speed = draws.uniform(1.5, 3.0) * situation.largest_speed();
    Shape::new(0.3, 0.95, move |size| vec![largest * (1.0 - size), speed])
}
