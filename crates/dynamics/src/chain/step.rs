//! What a step of the measuring chain is.

use crate::description::Description;
use crate::error::DynamicsError;
use crate::law::Values;
use crate::scalar::{Dual, Scalar};
use crate::units::{Coordinate, Observed};
use rand::Rng;

/// A number whose plain value decides between two pieces of a step, such as clipped or not.
pub trait Sampled: Scalar {
    /// The plain value, derivatives left aside.
    fn plain(self) -> f64;
}

impl Sampled for f64 {
    fn plain(self) -> f64 {
        self
    }
}

impl<const N: usize> Sampled for Dual<N> {
    fn plain(self) -> f64 {
        self.value
    }
}

/// A motion at the times at which a sensor samples it; all four of one length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampledMotion<'a, S> {
    /// The sensor's true sampling times in seconds, increasing.
    pub times_s: &'a [f64],
    /// Positions in rad or m.
    pub position: &'a [S],
    /// Velocities in rad/s or m/s.
    pub velocity: &'a [S],
    /// Accelerations in rad/s² or m/s².
    pub acceleration: &'a [S],
}

impl<'a, S> SampledMotion<'a, S> {
    /// What the sensor observes of it.
    pub(crate) fn observed(&self, observed: Observed) -> &'a [S] {
        match observed {
            Observed::Position => self.position,
            Observed::Velocity => self.velocity,
            Observed::Acceleration => self.acceleration,
        }
    }
}

/// Samples on their way through the measuring chain; the lists are of one length.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples<S> {
    /// Position of each sample in the sampling, from 0: those that got lost are missing.
    pub indices: Vec<usize>,
    /// When the sensor took it, in seconds. Nobody outside sees these.
    pub times_s: Vec<f64>,
    /// Values of the file, in the observed quantity's unit.
    pub values: Vec<S>,
    /// When the file says it was, in seconds.
    pub stamps_s: Vec<S>,
}

/// Sampling and values before the chain touches them, by which an impossible parameter is recognized.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Time from the first sample to the last, in seconds.
    pub duration_s: f64,
    /// The mean time between samples, in seconds.
    pub sample_period_s: f64,
    /// Smallest observed value.
    pub smallest: f64,
    /// Largest observed value.
    pub largest: f64,
    /// Observed quantity.
    pub observed: Observed,
    /// Coordinate of the motion: an angle or a displacement.
    pub coordinate: Coordinate,
}

/// An effect in the measuring chain.
pub trait Step {
    /// Returns the description: id, equation, parameters, signature and reference.
    const DESCRIPTION: &'static Description;

    /// True if values and stamps are differentiable in its parameters: [`Step::transform`] then is the whole
    /// step.
    const DIFFERENTIABLE: bool = false;

    /// A differentiable step, on numbers of any kind; nothing in a step that is not.
    ///
    /// The samples are all there still: every differentiable step but the one on the stamps comes before
    /// the first that loses any.
    fn transform<S: Sampled>(
        _values: &Values<S>,
        _motion: &SampledMotion<'_, S>,
        _observed: Observed,
        _samples: &mut Samples<S>,
    ) {
    }

    /// The step on doubles where it is not differentiable; `generator` is the step's own.
    fn distort<R: Rng + ?Sized>(_values: &Values<f64>, _samples: &mut Samples<f64>, _generator: &mut R) {}

    /// Refuses parameters that make no sense for this sampling and this motion.
    ///
    /// # Errors
    /// [`DynamicsError::Contradiction`] or [`DynamicsError::NotForThisSensor`].
    fn check(_values: &Values<f64>, _extent: &Extent) -> Result<(), DynamicsError> {
        Ok(())
    }
}
