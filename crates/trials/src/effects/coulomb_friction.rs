//! Coulomb friction: dry friction of constant size.

use super::bristles::bristles;
use super::size::Shape;
use super::{EffectClass, OtherLaw, Size, TrialEffect};
use crate::hidden::Bank;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::Releases, Bank::Measured, Bank::Driven, Bank::Stressed],
    other_law: Some(OtherLaw { name: "LuGre", draw: |situation, draws| bristles(None, situation, draws) }),
    alike: &[Effect::System(SystemEffect::StribeckFriction)],
    separable: [22.0, 17.0, 17.0],
    ..TrialEffect::new(
        Effect::System(SystemEffect::CoulombFriction),
        EffectClass::Friction,
        Size::Solved(|situation, _| Shape::scaled(1e-3, 0.1, situation.largest_torque())),
    )
};
