//! Flexible coupling: a second body on a spring.

use super::size::Shape;
use super::{DrawnLaw, EffectClass, OtherLaw, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::laws::SecondBody;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::LeftOut, Bank::Releases, Bank::Measured, Bank::Driven],
    other_law: Some(OtherLaw { name: "second body", draw: other_law }),
    ..TrialEffect::new(
        Effect::System(SystemEffect::FlexibleCoupling),
        EffectClass::SecondBody,
        Size::Solved(shape),
    )
};

/// Draws the second body's own angular frequency in rad/s.
fn frequency(situation: &Situation, draws: &mut Draws) -> f64 {
    draws.uniform(1.8, 5.0) * situation.omega()
}

fn shape(situation: &Situation, draws: &mut Draws) -> Shape {
    let (inertia, frequency) = (situation.nominal.inertia(), frequency(situation, draws));
    let damping = 2.0 * draws.log_uniform(0.002, 0.03) * frequency;
    Shape::new(1e-2, 1.0, move |size| {
        let own = size * inertia;
        vec![own, own * frequency * frequency, own * damping]
    })
}

fn other_law(situation: &Situation, draws: &mut Draws) -> DrawnLaw {
    let (inertia, frequency) = (situation.nominal.inertia(), frequency(situation, draws));
    let damping_ratio = draws.log_uniform(0.003, 0.04);
    let law = move |size: f64| SecondBody { inertia: size * inertia, frequency, damping_ratio };
    let parameters = move |size: f64| {
        let own = size * inertia;
        vec![own, own * frequency * frequency, 2.0 * own * damping_ratio * frequency]
    };
    DrawnLaw::new(1e-2, 0.5, law, parameters, format!("second body at {frequency:.3} rad/s"))
}
