//! Sensor saturation: a sensor whose range ends within the swing.

use super::size::Shape;
use super::{EffectClass, Size, TrialEffect};
use crate::hidden::Bank;
use crate::make::draws::Draws;
use crate::make::situation::Situation;
use dynamics::{ChainEffect, Effect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::LeftOut],
    ..TrialEffect::new(
        Effect::MeasuringChain(ChainEffect::SensorSaturation),
        EffectClass::Sensor,
        Size::Solved(shape),
    )
};

/// The range is symmetric about zero.
fn shape(situation: &Situation, _: &mut Draws) -> Shape {
    let largest = situation.amplitude + situation.nominal.rest_angle().abs();
    Shape::new(1e-2, 0.6, move |size| vec![largest * (1.0 - size)])
}
