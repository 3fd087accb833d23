//! Quadratic drag: drag that grows with the square of the velocity.

use super::size::Shape;
use super::{DrawnLaw, EffectClass, OtherLaw, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::laws::DragPower;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::LeftOut, Bank::Releases, Bank::Measured, Bank::Driven, Bank::Stressed],
    other_law: Some(OtherLaw { name: "drag of another power", draw: other_law }),
    separable: [22.0, 17.0, 18.0],
    ..TrialEffect::new(
        Effect::System(SystemEffect::QuadraticDrag),
        EffectClass::Damping,
        Size::Solved(|situation, _| Shape::scaled(1e-3, 1.0, situation.nominal.inertia())),
    )
};

fn other_law(situation: &Situation, draws: &mut Draws) -> DrawnLaw {
    let inertia = situation.nominal.inertia();
    let (exponent, velocity) = (draws.uniform(1.8, 2.2), 0.5 * situation.largest_speed());
    let law = move |size: f64| DragPower { coefficient: size * inertia, exponent, velocity };
    DrawnLaw::new(1e-3, 1.0, law, move |size| vec![size * inertia], format!("exponent {exponent:.3}"))
}
