//! Rules that derive the size of an effect from its wanted detectability.

use crate::make::draws::Draws;
use crate::make::situation::Situation;

/// Rule that derives the size of an effect from its wanted detectability.
#[derive(Clone, Copy)]
pub(crate) enum Size {
    /// Solve for the size after a shape is drawn.
    ///
    /// Torques are drawn in units of the spring's torque at the largest swing, velocities in units of the
    /// largest velocity, and times in units of the record's length. A shape then means the same for every
    /// system.
    Solved(fn(&Situation, &mut Draws) -> Shape),
    /// Compute the size from the expected sum of squares of the effect's contribution, E‖Δ‖², without
    /// projection. This applies to effects that are random or that act on every sample as noise would. A
    /// recalibration absorbs only a share of the order of the number of its unknowns divided by the number of
    /// samples.
    Expected(fn(&Wanted<'_>, &mut Draws) -> Expected),
}

/// All parameters of an effect except its size; the size is a positive number that is small for a small
/// effect.
pub(crate) struct Shape {
    /// Size from which the search starts.
    pub(crate) guess: f64,
    /// Largest size that makes sense.
    pub(crate) most: f64,
    /// Parameters at a size, in the order of the effect's description.
    pub(crate) values: Box<dyn Fn(f64) -> Vec<f64>>,
}

impl Shape {
    /// Builds a shape whose parameters are a function of the size.
    pub(crate) fn new(guess: f64, most: f64, values: impl Fn(f64) -> Vec<f64> + 'static) -> Self {
        Self { guess, most, values: Box::new(values) }
    }

    /// Builds a shape with one parameter, the size times a unit.
    pub(crate) fn scaled(guess: f64, most: f64, unit: f64) -> Self {
        Self::new(guess, most, move |size| vec![size * unit])
    }
}

/// Quantities that determine the size of a random effect.
pub(crate) struct Wanted<'a> {
    /// System and its records.
    pub(crate) situation: &'a Situation,
    /// Σθ̇² over all samples of all records, without hidden effects.
    pub(crate) square_velocities: f64,
    /// Standard deviation of all white disturbances together, in rad.
    pub(crate) white: f64,
    /// Wanted detectability.
    pub(crate) detectability: f64,
}

impl Wanted<'_> {
    /// Returns the number of samples of all records.
    pub(crate) fn samples(&self) -> f64 {
        (self.situation.sampling.samples * self.situation.starts.len()) as f64
    }

    /// Returns the time between samples in seconds.
    pub(crate) fn period(&self) -> f64 {
        1.0 / self.situation.sampling.rate_hz
    }

    /// Returns the wanted square root of E‖Δ‖², in rad.
    pub(crate) fn norm(&self) -> f64 {
        self.detectability * self.white
    }

    /// Returns √Σθ̇², kept above 0.
    pub(crate) fn speed(&self) -> f64 {
        self.square_velocities.sqrt().max(f64::MIN_POSITIVE)
    }
}

/// Parameters of a random effect and its detectability with them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Expected {
    pub(crate) values: Vec<f64>,
    pub(crate) detectability: f64,
}
