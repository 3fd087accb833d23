//! Dry friction by bending bristles, with or without a larger torque at rest.

use super::DrawnLaw;
use crate::make::draws::Draws;
use crate::make::laws::LuGre;
use crate::make::situation::Situation;

/// Draws LuGre friction. `static_ratio` is the static torque divided by the sliding torque, as in Stribeck
/// friction; without it, the law is like Coulomb friction.
pub(super) fn bristles(static_ratio: Option<f64>, situation: &Situation, draws: &mut Draws) -> DrawnLaw {
    let torque = situation.largest_torque();
    let velocity = draws.uniform(0.03, 0.3) * situation.largest_speed();
    // Bristles that bend farther would be hysteresis, and an answer could rightly say so.
    let bend = draws.log_uniform(1e-5, 1e-4) * situation.amplitude;
    let ratio = static_ratio.unwrap_or(1.0);
    let law = move |size: f64| LuGre {
        torque: size * torque,
        static_torque: ratio * size * torque,
        velocity,
        bend,
    };
    let parameters = move |size: f64| match static_ratio {
        None => vec![size * torque],
        Some(ratio) => vec![size * torque, ratio * size * torque, velocity],
    };
    DrawnLaw::new(1e-3, 0.1, law, parameters, format!("bristles bend by {bend:.2e} rad"))
}
