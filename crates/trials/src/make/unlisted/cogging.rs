//! Magnetic cogging.

use super::law::UnlistedLaw;
use crate::make::draws::Draws;
use crate::make::integrator::{Moment, TorqueLaw};
use crate::make::open_law::OpenLaw;
use crate::make::recalibration::Absorbed;
use crate::make::situation::Situation;
use dynamics::SystemEffect;
use std::f64::consts::PI;

pub(super) const LAW: UnlistedLaw = UnlistedLaw {
    name: "cogging",
    class: None,
    alone: Some(Absorbed {
        stand_ins: &[SystemEffect::CubicStiffness, SystemEffect::AsymmetricStiffness],
        ..Absorbed::BY_RECALIBRATION
    }),
    draw,
};

fn draw(situation: &Situation, draws: &mut Draws) -> (OpenLaw, String) {
    let (stiffness, swing) = (situation.nominal.stiffness(), situation.amplitude);
    let (teeth, phase) = ((8 + draws.below(17)) as f64, draws.uniform(-PI, PI));
    let law = move |size: f64| Cogging { torque: size * stiffness * swing, teeth, phase };
    (OpenLaw::new(1e-3, 0.5, law), format!("{teeth} a turn"))
}

/// −τ·sin(n·θ + φ): the attraction between a motor's magnets and its teeth, repeated n times per turn.
pub(crate) struct Cogging {
    pub(crate) torque: f64,
    pub(crate) teeth: f64,
    pub(crate) phase: f64,
}

impl TorqueLaw for Cogging {
    fn torque(&self, moment: &Moment) -> f64 {
        -self.torque * (self.teeth * moment.deflection + self.phase).sin()
    }
}
