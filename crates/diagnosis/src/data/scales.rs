//! Scales of a record that bounds and grids of parameters are stated in.

use std::f64::consts::{PI, TAU};

/// Scales of the motion, from the records and the nominal simulator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scales {
    /// Largest deflection, in rad or m.
    pub(crate) amplitude: f64,
    /// Largest and smallest position, in rad or m.
    pub(crate) highest: f64,
    pub(crate) lowest: f64,
    /// Largest absolute value that the sensor shows, in its own unit.
    pub(crate) reading: f64,
    /// Largest speed.
    pub(crate) speed: f64,
    /// Angular frequency in rad/s; without a spring one over the time constant.
    pub(crate) frequency: f64,
    /// Largest torque of the spring, or of the inertia where there is none.
    pub(crate) torque: f64,
    /// Largest torque of the input; 0 without one.
    pub(crate) input_torque: f64,
    /// Length of the longest record in seconds.
    pub(crate) duration: f64,
    /// Median time between samples in seconds.
    pub(crate) interval: f64,
    /// By how much a weight that the nominal simulator has moves the middle of the swing from where the spring is relaxed.
    pub(crate) rest_moved: f64,
    /// Whether the nominal simulator has Coulomb friction whose torque is recalibrated: that of further dry friction would
    /// be the same number once more.
    pub(crate) friction_known: bool,
    /// Nominal inertia, and the stiffness that gives the frequency with it.
    pub(crate) inertia: f64,
    pub(crate) stiffness: f64,
    /// Step of the sensor's readings in its own unit; 0 where they lie on none, or on one that is lost in the noise.
    pub(crate) resolution: f64,
    /// Largest relative standard error of a clock's rate; 0 where the stamps are believed.
    pub(crate) rate_error: f64,
    /// How a driven motion repeats; none of one that does not, or swings freely.
    pub(crate) repeats: Option<Repeats>,
    /// Error of an integration step relative to the amplitude: a small part of the noise, and no smaller.
    pub(crate) tolerance: f64,
}

/// A motion that is driven over the same way again and again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Repeats {
    /// Angular frequency of its repetition.
    pub(crate) frequency: f64,
    /// Angular frequencies that the record is too short to tell apart.
    pub(crate) resolution: f64,
}

impl Repeats {
    /// Whether an angular frequency is a multiple of the repetition's.
    pub(crate) fn has(&self, frequency: f64) -> bool {
        let order = (frequency / self.frequency).round().max(1.0);
        (frequency - order * self.frequency).abs() < 0.5 * self.resolution
    }
}

/// Finest and coarsest error of an integration step, and its part of the noise: a period takes about ten steps, so that
/// the errors of a whole segment stay below a tenth of the noise.
const FINEST: f64 = 1e-10;
const COARSEST: f64 = 1e-6;
const OF_NOISE: f64 = 1e-3;

/// A motion's frequencies relative to the swing's: far slower than it a second body drifts along, and above
/// the upper end hardly anything moves the body.
const SLOWEST_MODE: f64 = 0.3;
const FASTEST: f64 = 12.0;

/// Radians of a wave along the position over the amplitude, at most.
const MOST_WAVES: f64 = 64.0;

/// The highest angular frequency at which samples so far apart tell frequencies from their images, with room
/// for a line's width: 0.8 of half their rate.
pub(crate) fn below_images(interval: f64) -> f64 {
    0.8 * std::f64::consts::PI / interval
}

impl Scales {
    /// The highest angular frequency looked at in samples so far apart.
    pub(crate) fn highest_frequency(&self, interval: f64) -> f64 {
        (FASTEST * self.frequency).min(below_images(interval))
    }

    /// Angular frequencies that a second body may have, lowest and highest.
    pub(crate) fn modes(&self) -> [f64; 2] {
        let lowest = SLOWEST_MODE * self.frequency;
        [lowest, self.highest_frequency(self.interval).max(2.0 * lowest)]
    }

    /// Wavenumbers that a torque along the position may have, lowest and highest: it repeats at least twice within the
    /// swing, and at full speed samples still tell it from its images.
    pub(crate) fn waves(&self) -> [f64; 2] {
        let lowest = TAU / self.amplitude;
        let step = self.speed * self.interval;
        [lowest, (PI / step).min(MOST_WAVES / self.amplitude)]
    }

    /// The same with the tolerance that a noise of this size asks for, and without steps that it hides: those of the digits
    /// in a file, say.
    pub(crate) fn with_noise(self, noise: f64, span: f64) -> Self {
        let resolution = if self.resolution < noise { 0.0 } else { self.resolution };
        Self { tolerance: (OF_NOISE * noise / span).clamp(FINEST, COARSEST), resolution, ..self }
    }

    /// Tolerance while the noise is not known yet.
    pub(crate) const UNKNOWN_NOISE: f64 = 1e-9;
}
