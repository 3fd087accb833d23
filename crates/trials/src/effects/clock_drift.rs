//! Clock drift: a clock whose rate changes.

use super::size::Shape;
use super::{EffectClass, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::situation::Situation;
use dynamics::{ChainEffect, Effect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::Releases],
    separable: [26.0, 28.0, 26.0],
    ..TrialEffect::new(
        Effect::MeasuringChain(ChainEffect::ClockDrift),
        EffectClass::Drift,
        Size::Solved(shape),
    )
};

/// A constant error of the rate has the same effect as another stiffness and damping; its change does not.
fn shape(situation: &Situation, draws: &mut Draws) -> Shape {
    let (sign, rate) = (draws.sign(), draws.uniform(-0.5, 0.5));
    let duration = situation.duration();
    Shape::new(1e-4, 0.1, move |size| vec![rate * sign * size, sign * size / duration])
}
