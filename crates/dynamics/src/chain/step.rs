//! Interface of a step of the measurement chain.

use crate::description::Description;
use crate::error::DynamicsError;
use crate::law::Values;
use crate::scalar::{Dual, Scalar};
use crate::units::{Coordinate, Observed};
use rand::Rng;

/// Number whose plain value selects between two pieces of a step, such as clipped or not.
pub trait Sampled: Scalar {
    /// Returns the plain value without derivatives.
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

/// Motion at the times at which a sensor samples it; all four lists have the same length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampledMotion<'a, S> {
    /// True sampling times of the sensor in seconds, increasing.
    pub times_s: &'a [f64],
    /// Positions in rad or m.
    pub position: &'a [S],
    /// Velocities in rad/s or m/s.
    pub velocity: &'a [S],
    /// Accelerations in rad/s² or m/s².
    pub acceleration: &'a [S],
}

impl<'a, S> SampledMotion<'a, S> {
    /// Returns the observed quantity.
    pub(crate) fn observed(&self, observed: Observed) -> &'a [S] {
        match observed {
            Observed::Position => self.position,
            Observed::Velocity => self.velocity,
            Observed::Acceleration => self.acceleration,
        }
    }
}

/// Samples on their way through the measurement chain; all lists have the same length.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples<S> {
    /// Position of each sample in the sampling, from 0; lost samples are missing.
    pub indices: Vec<usize>,
    /// True sampling times in seconds. They are not part of the file.
    pub times_s: Vec<f64>,
    /// Values in the file, in the observed quantity's unit.
    pub values: Vec<S>,
    /// Time stamps in the file, in seconds.
    pub stamps_s: Vec<S>,
}

/// Sampling and values before the chain acts, against which parameters are checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Time from the first sample to the last, in seconds.
    pub duration_s: f64,
    /// Mean time between samples, in seconds.
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

/// Effect in the measurement chain.
pub trait Step {
    /// Description: id, equation, parameters, signature and reference.
    const DESCRIPTION: &'static Description;

    /// `true` if values and stamps are differentiable in the effect's parameters: [`Step::transform`] is then
    /// the whole step.
    const DIFFERENTIABLE: bool = false;

    /// Applies a differentiable step, over any scalar; does nothing in a step that is not differentiable.
    ///
    /// All samples are still present: every differentiable step except the one on the stamps comes before the
    /// first that loses samples.
    fn transform<S: Sampled>(
        _values: &Values<S>,
        _motion: &SampledMotion<'_, S>,
        _observed: Observed,
        _samples: &mut Samples<S>,
    ) {
    }

    /// Applies a step that is not differentiable, on doubles; `generator` is the step's own.
    fn distort<R: Rng + ?Sized>(_values: &Values<f64>, _samples: &mut Samples<f64>, _generator: &mut R) {}

    /// Rejects parameters that are impossible with this sampling and this motion.
    ///
    /// # Errors
    /// Returns [`DynamicsError::Contradiction`] or [`DynamicsError::NotForThisSensor`].
    fn check(_values: &Values<f64>, _extent: &Extent) -> Result<(), DynamicsError> {
        Ok(())
    }
}
