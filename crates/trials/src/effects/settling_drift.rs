//! A stiffness or a damping that drifts to another value and stays there.

use super::DrawnLaw;
use crate::make::draws::Draws;
use crate::make::laws::{Drifting, ExponentialDrift};
use crate::make::situation::Situation;

/// A drift that settles. Its size is the relative change over a record at the initial rate, from about the first of `sizes` up
/// to the second; `sign` draws its direction.
pub(super) fn settling_drift(
    of: Drifting,
    [guess, most]: [f64; 2],
    sign: fn(&mut Draws) -> f64,
    situation: &Situation,
    draws: &mut Draws,
) -> DrawnLaw {
    let duration = situation.duration();
    // One that settles as fast as the amplitude decays is what a cubic spring or another friction does.
    let settling = draws.uniform(1.5, 5.0) * duration;
    let sign = sign(draws);
    let rate = move |size: f64| sign * size / duration;
    let law = move |size: f64| ExponentialDrift { of, rate: rate(size), settling };
    DrawnLaw::new(guess, most, law, move |size| vec![rate(size)], format!("settles in {settling:.2} s"))
}
