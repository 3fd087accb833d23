//! End stop: a stop that limits the motion on one side.

use super::size::Shape;
use super::{DrawnLaw, EffectClass, OtherLaw, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::laws::HertzStop;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::LeftOut, Bank::Releases, Bank::Measured, Bank::Driven, Bank::Stressed],
    other_law: Some(OtherLaw { name: "Hertzian contact", draw: other_law }),
    ..TrialEffect::new(Effect::System(SystemEffect::EndStop), EffectClass::Play, Size::Solved(shape))
};

/// Draws the stop's distance from the rest angle in rad, and the contact's dissipation in s/rad. The stop is
/// on the side opposite to the start; on the start's own side it would be in contact from the beginning.
fn place(situation: &Situation, draws: &mut Draws) -> (f64, f64) {
    let deflection = situation.far_side() * draws.uniform(0.6, 0.9) * situation.amplitude;
    (deflection, draws.uniform(0.0, 0.3) / situation.largest_speed())
}

fn shape(situation: &Situation, draws: &mut Draws) -> Shape {
    let (deflection, dissipation) = place(situation, draws);
    let (angle, stiffness) = (situation.nominal.rest_angle() + deflection, situation.nominal.stiffness());
    Shape::new(1e-2, 1e4, move |size| vec![angle, size * stiffness, dissipation])
}

fn other_law(situation: &Situation, draws: &mut Draws) -> DrawnLaw {
    let (deflection, dissipation) = place(situation, draws);
    let (rest, stiffness) = (situation.nominal.rest_angle(), situation.nominal.stiffness());
    let swing = situation.amplitude;
    let hertz = move |size: f64| size * stiffness / swing.sqrt();
    let law = move |size: f64| HertzStop { deflection, stiffness: hertz(size), dissipation };
    // Stiffness of the linear contact with the same torque at a depth of a tenth of the swing.
    let linear = move |size: f64| hertz(size) * (0.1 * swing).sqrt();
    let parameters = move |size| vec![rest + deflection, linear(size), dissipation];
    DrawnLaw::new(1e-2, 1e4, law, parameters, "power 3/2".to_owned())
}
