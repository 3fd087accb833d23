//! Linear oscillator with the standard errors of its coefficients.

/// Value with its standard error, in the same unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimated {
    /// The value.
    pub value: f64,
    /// Standard error of the value.
    pub std_error: f64,
}

/// Linear oscillator per unit of inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearOscillator {
    /// Stiffness over inertia, ω₀², in 1/s²; 0 if the record shows no restoring torque.
    pub stiffness: Estimated,
    /// Damping over inertia, 2ζω₀, in 1/s; negative if the swing grows.
    pub damping: Estimated,
    /// Rest position, in the record's unit; `None` if the sensor does not observe the position or there is no
    /// restoring torque.
    pub rest: Option<Estimated>,
    /// Acceleration per unit of the input; `None` for a record without an input that changes.
    pub input_gain: Option<Estimated>,
    /// Data that the coefficients were estimated from.
    pub basis: Basis,
}

/// Data that an oscillator was estimated from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// Turning points of a free decay: their number.
    TurningPoints(usize),
    /// Damped sinusoids fitted to the samples of windows: their number.
    Samples(usize),
    /// Simulated response nearest to the samples: their number.
    Response(usize),
    /// Regression over smooth windows: their number.
    Windows(usize),
    /// The strongest of several modes: their number.
    Modes(usize),
}

impl LinearOscillator {
    /// Returns the undamped natural frequency ω₀/2π in Hz, with its first-order standard error; `None`
    /// without a restoring torque.
    #[must_use]
    pub fn natural_frequency_hz(&self) -> Option<Estimated> {
        let omega = self.omega()?;
        // dω = dk/(2ω).
        let std_error = self.stiffness.std_error / (2.0 * omega);
        Some(Estimated { value: omega, std_error }.times(1.0 / std::f64::consts::TAU))
    }

    /// Returns the damping ratio ζ = damping/(2ω₀), dimensionless, with the standard error of the damping
    /// alone; `None` without a restoring torque.
    #[must_use]
    pub fn damping_ratio(&self) -> Option<Estimated> {
        // The frequency is known far better than the damping, so that its error adds almost nothing.
        Some(self.damping.times(0.5 / self.omega()?))
    }

    fn omega(&self) -> Option<f64> {
        (self.stiffness.value > 0.0).then(|| self.stiffness.value.sqrt())
    }
}

/// Number of standard errors from which a number counts as different from zero.
const SIGNIFICANT: f64 = 3.0;

impl Estimated {
    /// Returns `true` if the value differs from zero by more than three standard errors.
    #[must_use]
    pub fn is_significant(self) -> bool {
        self.value.abs() > SIGNIFICANT * self.std_error
    }

    /// Returns the value and its standard error times a factor.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self { value: self.value * factor, std_error: self.std_error * factor.abs() }
    }
}
