//! Smooth torque of no known kind.

use super::law::UnlistedLaw;
use crate::make::draws::Draws;
use crate::make::integrator::{Moment, TorqueLaw};
use crate::make::open_law::OpenLaw;
use crate::make::situation::Situation;
use std::f64::consts::PI;

pub(super) const LAW: UnlistedLaw = UnlistedLaw { name: "field", class: None, alone: None, draw };

fn draw(situation: &Situation, draws: &mut Draws) -> (OpenLaw, String) {
    let (swing, speed) = (situation.amplitude, situation.largest_speed());
    let unit = situation.largest_torque();
    let mut term = || [draws.normal(), 2.5 * draws.normal(), 2.5 * draws.normal(), draws.uniform(-PI, PI)];
    let terms: Vec<[f64; 4]> = (0..3).map(|_| term()).collect();
    let law = move |size: f64| Field { torque: size * unit, swing, speed, terms: terms.clone() };
    (OpenLaw::new(1e-3, 0.3, law), "three waves".to_owned())
}

/// τ·Σ aᵢ·sin(kᵢ·x/A + lᵢ·ẋ/V + φᵢ): a random Fourier series in position and velocity.
pub(crate) struct Field {
    /// τ: scale of the torque.
    pub(crate) torque: f64,
    /// A, in rad.
    pub(crate) swing: f64,
    /// V, in rad/s.
    pub(crate) speed: f64,
    /// aᵢ, kᵢ, lᵢ and φᵢ of each term.
    pub(crate) terms: Vec<[f64; 4]>,
}

impl TorqueLaw for Field {
    fn torque(&self, moment: &Moment) -> f64 {
        let (x, v) = (moment.deflection / self.swing, moment.velocity / self.speed);
        self.torque * self.terms.iter().map(|[a, k, l, phase]| a * (k * x + l * v + phase).sin()).sum::<f64>()
    }
}
