//! Dropouts: lost samples.

use super::size::{Expected, Wanted};
use super::{EffectClass, Size, TrialEffect};
use crate::make::draws::Draws;
use dynamics::{ChainEffect, Effect};

pub(super) const EFFECT: TrialEffect = TrialEffect::new(
    Effect::MeasuringChain(ChainEffect::Dropouts),
    EffectClass::Stamps,
    Size::Expected(expected),
);

/// Lost samples change no value, so the detectability is 0. Their share is 0.2 % times the wanted
/// detectability, at most 30 %.
fn expected(wanted: &Wanted<'_>, draws: &mut Draws) -> Expected {
    let values = vec![(0.002 * wanted.detectability).min(0.3), draws.uniform(1.0, 8.0)];
    Expected { values, detectability: 0.0 }
}
