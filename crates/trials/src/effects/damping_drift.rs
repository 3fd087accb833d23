//! Damping drift: a damping that changes with time.

use super::settling_drift::settling_drift;
use super::size::Shape;
use super::{DrawnLaw, EffectClass, OtherLaw, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::laws::Drifting;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::LeftOut, Bank::Releases, Bank::Measured, Bank::Driven, Bank::Stressed],
    other_law: Some(OtherLaw { name: "drift that settles", draw: other_law }),
    separable: [10.0, 5.0, 5.0],
    ..TrialEffect::new(Effect::System(SystemEffect::DampingDrift), EffectClass::Damping, Size::Solved(shape))
};

/// A falling damping must not change its sign; a rising one may increase many times over.
fn shape(situation: &Situation, draws: &mut Draws) -> Shape {
    let falls = draws.chance(0.5);
    let (most, sign) = if falls { (0.95, -1.0) } else { (20.0, 1.0) };
    Shape::scaled(1e-2, most, sign / situation.duration())
}

fn other_law(situation: &Situation, draws: &mut Draws) -> DrawnLaw {
    let of = Drifting::Damping(situation.nominal.damping());
    settling_drift(of, [1e-2, 40.0], |_| 1.0, situation, draws)
}
