//! Outliers: wrong readings.

use super::size::{Expected, Wanted};
use super::{EffectClass, Size, TrialEffect};
use crate::make::draws::Draws;
use dynamics::{ChainEffect, Effect};

pub(super) const EFFECT: TrialEffect = TrialEffect::new(
    Effect::MeasuringChain(ChainEffect::Outliers),
    EffectClass::Sensor,
    Size::Expected(expected),
);

/// E‖Δ‖² = n·p·s²; the expected number of wrong samples is between 4 and 20.
fn expected(wanted: &Wanted<'_>, draws: &mut Draws) -> Expected {
    let count = draws.uniform(4.0, 20.0);
    let values = vec![count / wanted.samples(), wanted.norm() / count.sqrt()];
    Expected { values, detectability: wanted.detectability }
}
