//! Position-dependent damping: a damping that grows with the deflection.

use super::law::UnlistedLaw;
use crate::effects::EffectClass;
use crate::make::draws::Draws;
use crate::make::integrator::{Moment, TorqueLaw};
use crate::make::open_law::OpenLaw;
use crate::make::recalibration::Absorbed;
use crate::make::situation::Situation;
use dynamics::SystemEffect;

pub(super) const LAW: UnlistedLaw = UnlistedLaw {
    name: "position_damping",
    class: Some(EffectClass::Damping),
    alone: Some(Absorbed {
        stand_ins: &[SystemEffect::QuadraticDrag, SystemEffect::DampingDrift],
        ..Absorbed::BY_RECALIBRATION
    }),
    draw,
};

fn draw(situation: &Situation, _: &mut Draws) -> (OpenLaw, String) {
    let (damping, swing) = (situation.nominal.damping(), situation.amplitude);
    let law = move |size: f64| PositionDamping { coefficient: size * damping / (swing * swing) };
    (OpenLaw::new(1e-2, 100.0, law), "grows with the square".to_owned())
}

/// −c₂·x²·θ̇, as in van der Pol's oscillator.
pub(crate) struct PositionDamping {
    pub(crate) coefficient: f64,
}

impl TorqueLaw for PositionDamping {
    fn torque(&self, moment: &Moment) -> f64 {
        -self.coefficient * moment.deflection * moment.deflection * moment.velocity
    }
}
