//! Sensor quantization: rounded readings.

use super::size::{Expected, Wanted};
use super::{EffectClass, Size, TrialEffect};
use crate::make::draws::Draws;
use crate::make::nuisances::Nuisance;
use dynamics::{ChainEffect, Effect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    nuisance: Some(Nuisance::EncoderStep),
    ..TrialEffect::new(
        Effect::MeasuringChain(ChainEffect::SensorQuantization),
        EffectClass::Sensor,
        Size::Expected(expected),
    )
};

/// E‖Δ‖² = n·q²/12.
fn expected(wanted: &Wanted<'_>, _: &mut Draws) -> Expected {
    let step = wanted.norm() * (12.0 / wanted.samples()).sqrt();
    Expected { values: vec![step], detectability: wanted.detectability }
}
