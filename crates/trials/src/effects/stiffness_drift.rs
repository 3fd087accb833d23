//! Stiffness drift: a stiffness that changes with time.

use super::settling_drift::settling_drift;
use super::size::Shape;
use super::{DrawnLaw, EffectClass, OtherLaw, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::laws::Drifting;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::Releases, Bank::Measured, Bank::Driven, Bank::Stressed],
    other_law: Some(OtherLaw { name: "drift that settles", draw: other_law }),
    separable: [26.0, 28.0, 26.0],
    ..TrialEffect::new(
        Effect::System(SystemEffect::StiffnessDrift),
        EffectClass::Drift,
        Size::Solved(|situation, draws| Shape::scaled(1e-4, 0.5, draws.sign() / situation.duration())),
    )
};

fn other_law(situation: &Situation, draws: &mut Draws) -> DrawnLaw {
    let of = Drifting::Stiffness(situation.nominal.stiffness());
    settling_drift(of, [1e-4, 0.5], Draws::sign, situation, draws)
}
