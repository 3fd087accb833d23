//! Maxwell element: a spring that relaxes.

use super::law::UnlistedLaw;
use crate::make::draws::Draws;
use crate::make::integrator::{Hidden, Moment, TorqueLaw};
use crate::make::open_law::OpenLaw;
use crate::make::recalibration::Absorbed;
use crate::make::situation::Situation;
use dynamics::SystemEffect;

pub(super) const LAW: UnlistedLaw = UnlistedLaw {
    name: "maxwell",
    class: None,
    alone: Some(Absorbed {
        sensor_drift: true,
        stand_ins: &[SystemEffect::AsymmetricStiffness],
        ..Absorbed::BY_RECALIBRATION
    }),
    draw,
};

fn draw(situation: &Situation, draws: &mut Draws) -> (OpenLaw, String) {
    let stiffness = situation.nominal.stiffness();
    let time = draws.uniform(0.08, 0.4) * situation.duration();
    let law = move |size: f64| Maxwell { stiffness: size * stiffness, time };
    (OpenLaw::new(1e-3, 1.0, law), format!("relaxes in {time:.2} s"))
}

/// −k_m·(x − z) with ż = (x − z)/T: a spring and a damper in series, parallel to the nominal ones. It starts
/// relaxed.
pub(crate) struct Maxwell {
    pub(crate) stiffness: f64,
    /// Relaxation time in seconds.
    pub(crate) time: f64,
}

impl TorqueLaw for Maxwell {
    fn torque(&self, moment: &Moment) -> f64 {
        let [z, _] = moment.hidden;
        -self.stiffness * (moment.deflection - z)
    }

    fn relax(&self, moment: &Moment, duration: f64) -> Hidden {
        let [z, _] = moment.hidden;
        [moment.deflection + (z - moment.deflection) * (-duration / self.time).exp(), 0.0]
    }

    fn start(&self, deflection: f64, _: f64) -> Hidden {
        [deflection, 0.0]
    }
}
