//! A relaxing spring.

use crate::make::integrator::{Hidden, Moment, TorqueLaw};

/// −k_m·(x − z) with ż = (x − z)/T: a spring and a damper in series, beside the nominal ones. It starts relaxed.
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
