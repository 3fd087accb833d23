//! Periodic forcing: an external torque with one frequency.

use super::size::Shape;
use super::{DrawnLaw, EffectClass, OtherLaw, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::laws::WanderingForcing;
use crate::make::situation::Situation;
use dynamics::{Effect, SystemEffect};
use std::f64::consts::PI;

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::LeftOut, Bank::Driven, Bank::Stressed],
    other_law: Some(OtherLaw { name: "wandering phase", draw: other_law }),
    ..TrialEffect::new(
        Effect::System(SystemEffect::PeriodicForcing),
        EffectClass::Forcing,
        Size::Solved(shape),
    )
};

/// Draws the angular frequency in rad/s, well below or above the natural one, and the phase in rad.
fn wave(situation: &Situation, draws: &mut Draws) -> (f64, f64) {
    let below = draws.chance(0.5);
    let ratio = if below { draws.uniform(0.3, 0.8) } else { draws.uniform(1.25, 4.0) };
    (ratio * situation.omega(), draws.uniform(-PI, PI))
}

fn shape(situation: &Situation, draws: &mut Draws) -> Shape {
    let (torque, (frequency, phase)) = (situation.largest_torque(), wave(situation, draws));
    Shape::new(1e-3, 1.0, move |size| vec![size * torque, frequency, phase])
}

/// Draws a forcing whose phase wanders.
fn other_law(situation: &Situation, draws: &mut Draws) -> DrawnLaw {
    let (torque, (frequency, phase)) = (situation.largest_torque(), wave(situation, draws));
    let wander = draws.uniform(0.1, 0.6);
    let wander_frequency = draws.uniform(1.0, 6.0) * PI / situation.duration();
    let law = move |size: f64| WanderingForcing {
        torque: size * torque,
        frequency,
        phase,
        wander,
        wander_frequency,
    };
    let parameters = move |size: f64| vec![size * torque, frequency, phase];
    DrawnLaw::new(1e-3, 1.0, law, parameters, format!("phase wanders by {wander:.2} rad"))
}
