//! Settling drift: a stiffness or a damping that drifts to another value and stays there.

use super::DrawnLaw;
use crate::make::draws::Draws;
use crate::make::laws::{Drifting, ExponentialDrift};
use crate::make::situation::Situation;

/// Draws a drift that settles. Its size is the relative change over a record at the initial rate. `sizes` are
/// the guess and the largest size; `sign` draws the direction.
pub(super) fn settling_drift(
    of: Drifting,
    [guess, most]: [f64; 2],
    sign: fn(&mut Draws) -> f64,
    situation: &Situation,
    draws: &mut Draws,
) -> DrawnLaw {
    let duration = situation.duration();
    // A drift that settles as fast as the amplitude decays would resemble a cubic spring or another friction.
    let settling = draws.uniform(1.5, 5.0) * duration;
    let sign = sign(draws);
    let rate = move |size: f64| sign * size / duration;
    let law = move |size: f64| ExponentialDrift { of, rate: rate(size), settling };
    DrawnLaw::new(guess, most, law, move |size| vec![rate(size)], format!("settles in {settling:.2} s"))
}
