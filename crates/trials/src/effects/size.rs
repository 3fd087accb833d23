//! How the size of an effect follows from how detectable it is to be.

use crate::make::draws::Draws;
use crate::make::situation::Situation;

/// How the size of an effect follows from a detectability.
#[derive(Clone, Copy)]
pub(crate) enum Size {
    /// By solving, once a shape is drawn.
    ///
    /// Torques are drawn in units of the spring's at the largest swing, velocities in those of the largest
    /// velocity, times in those of the record's length: a shape then means the same for every system.
    Solved(fn(&Situation, &mut Draws) -> Shape),
    /// From the expected sum of squares of what the effect does, E‖Δ‖², without projection: of effects that are random, or
    /// do to every sample the same as noise would. What a recalibration absorbs of it is of the order of the number of its
    /// unknowns over that of the samples.
    Expected(fn(&Wanted<'_>, &mut Draws) -> Expected),
}

/// All parameters of an effect but its size, a number above 0 that is small for a small effect.
pub(crate) struct Shape {
    /// A size to start from.
    pub(crate) guess: f64,
    /// The largest size that makes sense.
    pub(crate) most: f64,
    /// Parameters in the order of the effect's description, at a size.
    pub(crate) values: Box<dyn Fn(f64) -> Vec<f64>>,
}

impl Shape {
    /// A shape whose parameters are a function of the size.
    pub(crate) fn new(guess: f64, most: f64, values: impl Fn(f64) -> Vec<f64> + 'static) -> Self {
        Self { guess, most, values: Box::new(values) }
    }

    /// One parameter, which is the size times a unit.
    pub(crate) fn scaled(guess: f64, most: f64, unit: f64) -> Self {
        Self::new(guess, most, move |size| vec![size * unit])
    }
}

/// What the size of a random effect follows from.
pub(crate) struct Wanted<'a> {
    /// The system and its records.
    pub(crate) situation: &'a Situation,
    /// Σθ̇² over all samples of all records, without anything hidden.
    pub(crate) square_velocities: f64,
    /// Standard deviation of all that is white, in rad.
    pub(crate) white: f64,
    /// The detectability wanted.
    pub(crate) detectability: f64,
}

impl Wanted<'_> {
    /// Number of samples of all records.
    pub(crate) fn samples(&self) -> f64 {
        (self.situation.sampling.samples * self.situation.starts.len()) as f64
    }

    /// Time between samples in seconds.
    pub(crate) fn period(&self) -> f64 {
        1.0 / self.situation.sampling.rate_hz
    }

    /// Root of E‖Δ‖² as wanted, in rad.
    pub(crate) fn norm(&self) -> f64 {
        self.detectability * self.white
    }

    /// √Σθ̇², above 0.
    pub(crate) fn speed(&self) -> f64 {
        self.square_velocities.sqrt().max(f64::MIN_POSITIVE)
    }
}

/// Parameters of a random effect and how detectable it is with them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Expected {
    pub(crate) values: Vec<f64>,
    pub(crate) detectability: f64,
}
