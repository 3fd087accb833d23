//! Gravity: the weight of an arm.

use super::size::Shape;
use super::{DrawnLaw, EffectClass, OtherLaw, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::laws::Weight;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};
use std::f64::consts::{FRAC_PI_2, PI};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::Releases, Bank::Measured, Bank::Driven],
    other_law: Some(OtherLaw { name: "weight", draw: other_law }),
    separable: [354.0, 301.0, 122.0],
    ..TrialEffect::new(Effect::System(SystemEffect::Gravity), EffectClass::Restoring, Size::Solved(shape))
};

fn shape(situation: &Situation, draws: &mut Draws) -> Shape {
    let (stiffness, angle) = (situation.nominal.stiffness(), draws.uniform(0.0, FRAC_PI_2));
    Shape::new(1e-2, 0.8, move |size| vec![size * stiffness, angle])
}

fn other_law(situation: &Situation, draws: &mut Draws) -> DrawnLaw {
    let (stiffness, angle) = (situation.nominal.stiffness(), draws.uniform(-PI, PI));
    let law = move |size: f64| Weight { torque: size * stiffness, angle };
    // The vocabulary measures the angle from position 0.
    let from_zero = angle - situation.nominal.rest_angle();
    let parameters = move |size| vec![size * stiffness, from_zero];
    DrawnLaw::new(1e-2, 0.6, law, parameters, format!("at {angle:.3} rad"))
}
