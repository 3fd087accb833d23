//! Timestamp batching: samples that arrive in bursts.

use super::size::{Expected, Wanted};
use super::{EffectClass, Size, TrialEffect};
use crate::make::draws::Draws;
use crate::make::nuisances::Nuisance;
use dynamics::{ChainEffect, Effect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    nuisance: Some(Nuisance::Clock),
    ..TrialEffect::new(
        Effect::MeasuringChain(ChainEffect::TimestampBatching),
        EffectClass::Stamps,
        Size::Expected(expected),
    )
};

/// Timestamps are late by anything up to an interval, so that E‖PΔ‖² ≈ T_b²/12·Σθ̇². Bursts are drawn as
/// loggers make them, 10 to 80 ms apart, whatever detectability is wanted; the resulting detectability is
/// returned.
fn expected(wanted: &Wanted<'_>, draws: &mut Draws) -> Expected {
    let most = (0.1 * wanted.situation.duration()).max(4.0 * wanted.period());
    let interval = draws.uniform(0.01, 0.08).clamp(2.0 * wanted.period(), most);
    let values = vec![interval, draws.uniform(0.0, 0.1) * interval];
    Expected { values, detectability: interval / 12.0_f64.sqrt() * wanted.speed() / wanted.white }
}
