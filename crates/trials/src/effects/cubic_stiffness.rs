//! Cubic stiffness: a spring that hardens or softens.

use super::size::Shape;
use super::{DrawnLaw, EffectClass, OtherLaw, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::laws::SineSpring;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::Releases, Bank::Measured, Bank::Driven, Bank::Stressed],
    other_law: Some(OtherLaw { name: "sine spring", draw: other_law }),
    separable: [354.0, 301.0, 122.0],
    ..TrialEffect::new(
        Effect::System(SystemEffect::CubicStiffness),
        EffectClass::Restoring,
        Size::Solved(shape),
    )
};

fn shape(situation: &Situation, draws: &mut Draws) -> Shape {
    let unit = draws.sign() * situation.nominal.stiffness() / situation.amplitude.powi(2);
    Shape::scaled(1e-3, 0.4, unit)
}

fn other_law(situation: &Situation, draws: &mut Draws) -> DrawnLaw {
    let (stiffness, swing) = (situation.nominal.stiffness(), situation.amplitude);
    let (sign, steepness) = (draws.sign(), draws.uniform(0.5, 1.5) / swing);
    let hyperbolic = draws.chance(0.5);
    let coefficient = move |size: f64| sign * size * stiffness / (swing * swing);
    let law = move |size: f64| SineSpring { coefficient: coefficient(size), steepness, hyperbolic };
    let words = format!("steepness {steepness:.3}, hyperbolic {hyperbolic}");
    DrawnLaw::new(1e-3, 0.4, law, move |size| vec![coefficient(size)], words)
}
