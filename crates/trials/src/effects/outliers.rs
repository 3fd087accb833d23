//! Wrong readings.

use super::size::{Expected, Wanted};
use super::{EffectClass, Size, TrialEffect};
use crate::make::draws::Draws;
use dynamics::{ChainEffect, Effect};

pub(super) const EFFECT: TrialEffect = TrialEffect::new(
    Effect::MeasuringChain(ChainEffect::Outliers),
    EffectClass::Sensor,
    Size::Expected(expected),
);

/// E‖Δ‖² = n·p·s², with 4 to 20 wrong samples expected.
fn expected(wanted: &Wanted<'_>, draws: &mut Draws) -> Expected {
    let count = draws.uniform(4.0, 20.0);
    let values = vec![count / wanted.samples(), wanted.norm() / count.sqrt()];
    Expected { values, detectability: wanted.detectability }
}
