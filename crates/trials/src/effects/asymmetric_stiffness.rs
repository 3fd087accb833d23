//! Asymmetric stiffness: a spring that is stiffer on one side.

use super::size::Shape;
use super::{DrawnLaw, EffectClass, OtherLaw, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::laws::ExponentialSpring;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::Releases, Bank::Measured, Bank::Driven, Bank::Stressed],
    other_law: Some(OtherLaw { name: "exponential spring", draw: other_law }),
    separable: [68.0, 68.0, 45.0],
    ..TrialEffect::new(
        Effect::System(SystemEffect::AsymmetricStiffness),
        EffectClass::Restoring,
        Size::Solved(shape),
    )
};

fn shape(situation: &Situation, draws: &mut Draws) -> Shape {
    Shape::scaled(1e-3, 0.3, draws.sign() * situation.nominal.stiffness() / situation.amplitude)
}

fn other_law(situation: &Situation, draws: &mut Draws) -> DrawnLaw {
    let (stiffness, swing) = (situation.nominal.stiffness(), situation.amplitude);
    // A steeper spring would contain so much of a cubic spring that both together resemble gravity.
    let (sign, steepness) = (draws.sign(), draws.sign() * draws.uniform(0.05, 0.2) / swing);
    let coefficient = move |size: f64| sign * size * stiffness / swing;
    let law = move |size: f64| ExponentialSpring { coefficient: coefficient(size), steepness };
    let words = format!("steepness {steepness:.3}");
    DrawnLaw::new(1e-3, 0.3, law, move |size| vec![coefficient(size)], words)
}
