//! Dead band of the drive: small errors of a servo give no torque.

use super::size::Shape;
use super::{EffectClass, Size, TrialEffect};
use crate::hidden::Bank;
use dynamics::{Effect, SystemEffect};

pub(super) const EFFECT: TrialEffect = TrialEffect {
    banks: &[Bank::Driven],
    needs_input: true,
    ..TrialEffect::new(
        Effect::System(SystemEffect::DriveDeadBand),
        EffectClass::Play,
        Size::Solved(|situation, _| Shape::scaled(1e-3, 0.3, situation.amplitude)),
    )
};
