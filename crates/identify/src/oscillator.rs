//! A linear oscillator with the errors of its numbers.

/// A number with its standard error, in the same unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimated {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
}

/// A linear oscillator per unit of inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearOscillator {
    /// Stiffness over inertia, ω₀², in 1/s²; 0 where the record shows no restoring torque.
    pub stiffness: Estimated,
    /// Damping over inertia, 2ζω₀, in 1/s; negative where the swing grows.
    pub damping: Estimated,
    /// Rest position, in the record's unit; `None` where the sensor observes no position or nothing restores it.
    pub rest: Option<Estimated>,
    /// Acceleration per unit of the input; `None` for a record without one.
    pub input_gain: Option<Estimated>,
    /// What the numbers were read from.
    pub basis: Basis,
}

/// What an oscillator was read from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// So many turning points of a free decay.
    TurningPoints(usize),
    /// A regression over so many smooth windows.
    Windows(usize),
}

impl LinearOscillator {
    /// Undamped natural frequency ω₀/2π in Hz, with its standard error to first order; `None` without a restoring torque.
    #[must_use]
    pub fn natural_frequency_hz(&self) -> Option<Estimated> {
        let omega = self.omega()?;
        // dω = dk/(2ω).
        let std_error = self.stiffness.std_error / (2.0 * omega);
        Some(Estimated { value: omega, std_error }.times(1.0 / std::f64::consts::TAU))
    }

    /// Damping ratio ζ = damping/(2ω₀), without unit, with the standard error of the damping alone; `None` without a restoring
    /// torque.
    #[must_use]
    pub fn damping_ratio(&self) -> Option<Estimated> {
        // The frequency is known far better than the damping, so that its error adds nothing.
        Some(self.damping.times(0.5 / self.omega()?))
    }

    fn omega(&self) -> Option<f64> {
        (self.stiffness.value > 0.0).then(|| self.stiffness.value.sqrt())
    }
}

impl Estimated {
    pub(crate) fn times(self, factor: f64) -> Self {
        Self { value: self.value * factor, std_error: self.std_error * factor.abs() }
    }
}
