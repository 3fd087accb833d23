//! Timestamp jitter: timestamps with independent errors.

use super::size::{Expected, Wanted};
use super::{EffectClass, Size, TrialEffect};
use crate::make::draws::Draws;
use crate::make::nuisances::Nuisance;
use dynamics::{ChainEffect, Effect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    nuisance: Some(Nuisance::Clock),
    ..TrialEffect::new(
        Effect::MeasuringChain(ChainEffect::TimestampJitter),
        EffectClass::Stamps,
        Size::Expected(expected),
    )
};

/// E‖Δ‖² = σ_t²·Σθ̇²; σ_t is at most 0.45 sample periods.
fn expected(wanted: &Wanted<'_>, _: &mut Draws) -> Expected {
    let deviation = (wanted.norm() / wanted.speed()).min(0.45 * wanted.period());
    Expected { values: vec![deviation], detectability: deviation * wanted.speed() / wanted.white }
}
