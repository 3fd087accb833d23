//! Constant torque: a preload.

use super::size::Shape;
use super::{EffectClass, Size, TrialEffect};
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    // A preload acts as a rest angle that the simulator lacks.
    moves_rest_angle: true,
    ..TrialEffect::new(
        Effect::System(SystemEffect::ConstantTorque),
        EffectClass::Preload,
        Size::Solved(|situation, draws| Shape::scaled(1e-3, 0.3, draws.sign() * situation.largest_torque())),
    )
};
