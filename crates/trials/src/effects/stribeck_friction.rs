//! Stribeck friction: dry friction that is larger at rest.

use super::bristles::bristles;
use super::size::Shape;
use super::{DrawnLaw, EffectClass, OtherLaw, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::Releases, Bank::Measured, Bank::Driven, Bank::Stressed],
    other_law: Some(OtherLaw { name: "LuGre", draw: other_law }),
    alike: &[Effect::System(SystemEffect::CoulombFriction)],
    separable: [11.0, 6.0, 6.0],
    ..TrialEffect::new(
        Effect::System(SystemEffect::StribeckFriction),
        EffectClass::Friction,
        Size::Solved(shape),
    )
};

/// Draws the static torque divided by the sliding torque.
fn static_ratio(draws: &mut Draws) -> f64 {
    draws.uniform(1.5, 3.0)
}

fn shape(situation: &Situation, draws: &mut Draws) -> Shape {
    let torque = situation.largest_torque();
    let (ratio, velocity) = (static_ratio(draws), draws.uniform(0.03, 0.3) * situation.largest_speed());
    Shape::new(1e-3, 0.1, move |size| vec![size * torque, ratio * size * torque, velocity])
}

fn other_law(situation: &Situation, draws: &mut Draws) -> DrawnLaw {
    let ratio = static_ratio(draws);
    bristles(Some(ratio), situation, draws)
}
