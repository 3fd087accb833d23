//! Hysteresis: a torque that depends on where the motion turned.

use super::size::Shape;
use super::{DrawnLaw, EffectClass, OtherLaw, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::laws::BoucWen;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::Releases, Bank::Measured, Bank::Driven, Bank::Stressed],
    other_law: Some(OtherLaw { name: "Bouc-Wen", draw: other_law }),
    separable: [17.0, 16.0, 16.0],
    ..TrialEffect::new(Effect::System(SystemEffect::Hysteresis), EffectClass::Friction, Size::Solved(shape))
};

/// Draws the displacement over which the torque reverses, in rad.
fn displacement(situation: &Situation, draws: &mut Draws) -> f64 {
    draws.log_uniform(0.02, 0.3) * situation.amplitude
}

fn shape(situation: &Situation, draws: &mut Draws) -> Shape {
    let (torque, displacement) = (situation.largest_torque(), displacement(situation, draws));
    Shape::new(1e-3, 0.1, move |size| vec![size * torque, displacement])
}

fn other_law(situation: &Situation, draws: &mut Draws) -> DrawnLaw {
    let torque = situation.largest_torque();
    let (displacement, sharpness) = (displacement(situation, draws), draws.uniform(1.5, 4.0));
    let law = move |size: f64| BoucWen { torque: size * torque, displacement, sharpness };
    let parameters = move |size: f64| vec![size * torque, displacement];
    DrawnLaw::new(1e-3, 0.1, law, parameters, format!("sharpness {sharpness:.2}"))
}
