//! Parametric excitation: a stiffness that is modulated in time.

use super::law::UnlistedLaw;
use crate::effects::EffectClass;
use crate::make::draws::Draws;
use crate::make::integrator::{Moment, TorqueLaw};
use crate::make::open_law::OpenLaw;
use crate::make::recalibration::Absorbed;
use crate::make::situation::Situation;
use dynamics::SystemEffect;
use std::f64::consts::PI;

pub(super) const LAW: UnlistedLaw = UnlistedLaw {
    name: "parametric",
    class: Some(EffectClass::Drift),
    alone: Some(Absorbed {
        stand_ins: &[SystemEffect::StiffnessDrift, SystemEffect::CubicStiffness],
        ..Absorbed::BY_RECALIBRATION
    }),
    draw,
};

fn draw(situation: &Situation, draws: &mut Draws) -> (OpenLaw, String) {
    let (stiffness, omega) = (situation.nominal.stiffness(), situation.omega());
    // Away from twice the natural frequency, at which the motion would grow without bound.
    let ratio = if draws.chance(0.5) { draws.uniform(0.02, 0.5) } else { draws.uniform(0.6, 1.4) };
    let phase = draws.uniform(-PI, PI);
    let law = move |size: f64| Parametric { stiffness: size * stiffness, frequency: ratio * omega, phase };
    (OpenLaw::new(1e-3, 0.3, law), format!("{ratio:.3} of the natural frequency"))
}

/// −k·ε·sin(Ω·t + φ)·x.
pub(crate) struct Parametric {
    /// k·ε.
    pub(crate) stiffness: f64,
    /// Ω in rad/s.
    pub(crate) frequency: f64,
    pub(crate) phase: f64,
}

impl TorqueLaw for Parametric {
    fn torque(&self, moment: &Moment) -> f64 {
        -self.stiffness * (self.frequency * moment.time + self.phase).sin() * moment.deflection
    }
}
