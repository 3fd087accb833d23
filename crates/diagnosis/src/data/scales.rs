//! Scales of the records, in which bounds and grids of parameters are stated.

use crate::noise::periodogram::below_images;
use std::f64::consts::{PI, TAU};

/// Scales of the motion, computed from the records and the nominal simulator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scales {
    /// Largest deflection from the equilibrium, in rad or m.
    pub(crate) amplitude: f64,
    /// Largest and smallest position, in rad or m.
    pub(crate) highest: f64,
    pub(crate) lowest: f64,
    /// Largest absolute reading, in the sensor's own unit.
    pub(crate) reading: f64,
    /// Largest speed, in rad/s or m/s.
    pub(crate) speed: f64,
    /// Angular frequency in rad/s; without a spring the inverse of the time constant.
    pub(crate) frequency: f64,
    /// Largest torque of the spring, or of the inertia if there is no spring.
    pub(crate) torque: f64,
    /// Largest torque of the input; 0 without an input.
    pub(crate) input_torque: f64,
    /// Largest torque of a servo's drive that moves as the records do, without its damping; 0 without an input.
    pub(crate) drive_torque: f64,
    /// Largest error of that drive, as a position: its torque over the nominal stiffness; 0 without either.
    pub(crate) drive_error: f64,
    /// Length of the longest record in seconds.
    pub(crate) duration: f64,
    /// Median time between samples, in seconds.
    pub(crate) interval: f64,
    /// Shift of the swing's middle from the spring's rest angle that a weight of the nominal simulator
    /// causes.
    pub(crate) rest_moved: f64,
    /// `true` if the nominal simulator has Coulomb friction whose torque is recalibrated. Further dry
    /// friction would have the same torque as a parameter.
    pub(crate) friction_known: bool,
    /// Nominal inertia, and the stiffness that yields `frequency` with it.
    pub(crate) inertia: f64,
    pub(crate) stiffness: f64,
    /// Step of the sensor's readings in its own unit; 0 if they lie on no lattice, or on one that the noise
    /// hides.
    pub(crate) resolution: f64,
    /// Largest relative standard error of a clock's rate; 0 if the clocks use the stamps as they are.
    pub(crate) rate_error: f64,
    /// Repetition of a driven motion; `None` if it does not repeat, or if the swing is free.
    pub(crate) repeats: Option<Repeats>,
    /// Error of an integration step relative to the amplitude: a small part of the noise, within limits.
    pub(crate) tolerance: f64,
    /// Standard deviation of the noise in the sensor's own unit; 0 while it is not known.
    pub(crate) noise: f64,
    /// Nominal damping, and the spectral density of the drive's noise (two-sided).
    pub(crate) damping: f64,
    pub(crate) drive_noise: f64,
}

/// Repetition of a driven motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Repeats {
    /// Angular frequency of the repetition, in rad/s.
    pub(crate) frequency: f64,
    /// Difference of angular frequencies that the record is too short to resolve, in rad/s.
    pub(crate) resolution: f64,
}

impl Repeats {
    /// Returns `true` if an angular frequency is a multiple of the repetition's.
    pub(crate) fn has(&self, frequency: f64) -> bool {
        let order = (frequency / self.frequency).round().max(1.0);
        (frequency - order * self.frequency).abs() < 0.5 * self.resolution
    }
}

/// Smallest and largest relative error of an integration step, and its ratio to the noise. A period takes
/// about ten steps, so that the errors of a whole segment stay below a tenth of the noise.
const FINEST: f64 = 1e-10;
const COARSEST: f64 = 1e-6;
const OF_NOISE: f64 = 1e-3;

/// Limits of a second mode's frequency relative to the swing's. A far slower second body drifts along with
/// the swing, and above the upper limit hardly anything moves the body.
const SLOWEST_MODE: f64 = 0.3;
const FASTEST: f64 = 12.0;

/// Largest wavenumber of a torque along the position, as radians of its wave per amplitude.
const MOST_WAVES: f64 = 64.0;

impl Scales {
    /// Returns the highest angular frequency that is searched in samples `interval` seconds apart.
    pub(crate) fn highest_frequency(&self, interval: f64) -> f64 {
        (FASTEST * self.frequency).min(below_images(interval))
    }

    /// Returns the lowest and the highest angular frequency that a second body may have.
    pub(crate) fn modes(&self) -> [f64; 2] {
        let lowest = SLOWEST_MODE * self.frequency;
        [lowest, self.highest_frequency(self.interval).max(2.0 * lowest)]
    }

    /// Returns the lowest and the highest wavenumber that a torque along the position may have. At the lowest
    /// it repeats twice within the swing; at the highest the samples still resolve it at full speed.
    pub(crate) fn waves(&self) -> [f64; 2] {
        let lowest = TAU / self.amplitude;
        let step = self.speed * self.interval;
        [lowest, (PI / step).min(MOST_WAVES / self.amplitude)]
    }

    /// Returns the same scales with the tolerance that suits a noise of this size, and without a resolution
    /// that the noise hides, such as that of a file's decimal digits. `span` is half the range of the values,
    /// in the same unit as `noise`.
    pub(crate) fn with_noise(self, noise: f64, span: f64) -> Self {
        let resolution = if self.resolution < noise { 0.0 } else { self.resolution };
        Self { tolerance: (OF_NOISE * noise / span).clamp(FINEST, COARSEST), resolution, noise, ..self }
    }

    /// Returns the spectral density, two-sided, by which the drive's noise moves the system at an angular frequency.
    pub(crate) fn moved_by_drive(&self, omega: f64) -> f64 {
        let spring = self.stiffness - self.inertia * omega * omega;
        let divisor = spring * spring + (self.damping * omega).powi(2);
        if self.drive_noise > 0.0 && divisor > 0.0 { self.drive_noise / divisor } else { 0.0 }
    }

    /// Returns the standard deviation of readings with white noise of the given size and the drive's noise: white
    /// torque of density S moves an oscillator by a variance of S/(2ck).
    pub(crate) fn with_drive(&self, noise: f64) -> f64 {
        let divisor = 2.0 * self.damping * self.stiffness;
        let moved = if self.drive_noise > 0.0 && divisor > 0.0 { self.drive_noise / divisor } else { 0.0 };
        (noise * noise + moved).sqrt()
    }

    /// Tolerance while the noise is not yet known.
    pub(crate) const UNKNOWN_NOISE: f64 = 1e-9;
}
