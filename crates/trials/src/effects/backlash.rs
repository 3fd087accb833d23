//! Backlash: play in a drive.

use super::size::Shape;
use super::{DrawnLaw, EffectClass, OtherLaw, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::laws::RoundedBacklash;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::LeftOut, Bank::Releases, Bank::Measured, Bank::Driven, Bank::Stressed],
    other_law: Some(OtherLaw { name: "rounded dead zone", draw: other_law }),
    separable: [8.0, 8.0, 8.0],
    ..TrialEffect::new(
        Effect::System(SystemEffect::Backlash),
        EffectClass::Play,
        Size::Solved(|situation, _| Shape::scaled(1e-3, 0.3, situation.amplitude)),
    )
};

fn other_law(situation: &Situation, _: &mut Draws) -> DrawnLaw {
    let (stiffness, swing) = (situation.nominal.stiffness(), situation.amplitude);
    let law = move |size: f64| RoundedBacklash { stiffness, half_width: size * swing };
    let words = "edges round over the half width".to_owned();
    DrawnLaw::new(1e-3, 0.3, law, move |size| vec![size * swing], words)
}
