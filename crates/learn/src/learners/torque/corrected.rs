//! Nominal oscillator with a learned correction.

use crate::Place;
use crate::data::{DataSet, Scale};
use crate::flow::{Field, Slope};
use serde::{Deserialize, Serialize};

/// Learned function of scaled position, velocity and input, smooth in all of them.
pub trait Correction: Send + Sync {
    /// Returns the number of weights.
    fn weights(&self) -> usize;

    /// Returns the value.
    fn value(&self, weights: &[f64], z: [f64; 3]) -> f64;

    /// Returns the value and its derivatives with respect to scaled position and velocity. Writes the
    /// derivatives with respect to each weight into `slope`, which is as long as the weights.
    fn sloped(&self, weights: &[f64], z: [f64; 3], slope: &mut [f64]) -> (f64, [f64; 2]);
}

/// Acceleration that a correction is added to: the nominal oscillator per inertia, trained linear terms and
/// dry friction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Base {
    /// Nominal stiffness, damping, rest position and input gain, divided by the inertia; zeros without a
    /// nominal simulator.
    pub nominal: [f64; 4],
    /// Scales of the training part.
    pub scale: Scale,
    /// `true` if there is an input.
    pub driven: bool,
    /// `true` if dry friction is among the trained terms.
    pub friction: bool,
}

impl Base {
    /// Takes nominal oscillator and scales from a data set.
    #[must_use]
    pub fn new(data: &DataSet, friction: bool) -> Self {
        let nominal = data.nominal.as_ref().map_or([0.0; 4], |simulator| {
            let own = simulator.nominal();
            let inertia = own.inertia();
            [own.stiffness() / inertia, own.damping() / inertia, own.rest_angle(), own.input_gain() / inertia]
        });
        Self { nominal, scale: data.scale, driven: data.is_driven(), friction }
    }

    /// Returns the number of trained weights of the base: constant, position, velocity and, if they apply,
    /// input and dry friction.
    #[must_use]
    pub fn weights(&self) -> usize {
        3 + usize::from(self.driven) + usize::from(self.friction)
    }

    fn scaled(&self, place: &Place) -> [f64; 3] {
        let scale = &self.scale;
        let input = if self.driven { (place.input - scale.input_center) / scale.input } else { 0.0 };
        [(place.position - scale.center) / scale.position, place.velocity / scale.velocity, input]
    }

    fn known(&self, place: &Place) -> f64 {
        let [stiffness, damping, rest, gain] = self.nominal;
        let input = if self.driven { gain * place.input } else { 0.0 };
        input - stiffness * (place.position - rest) - damping * place.velocity
    }

    /// Returns the features of the trained linear terms.
    fn features(&self, place: &Place, [x, v, u]: [f64; 3]) -> impl Iterator<Item = f64> {
        let input = self.driven.then_some(u);
        let friction = self.friction.then_some(place.direction);
        [1.0, x, v].into_iter().chain(input).chain(friction)
    }
}

/// Nominal oscillator with trained linear terms, dry friction and a correction.
///
/// The weights are those of the base, then those of the correction, all in units of the training part's
/// acceleration.
#[derive(Debug, Clone, PartialEq)]
pub struct Corrected<C> {
    /// The base.
    pub base: Base,
    /// The correction.
    pub correction: C,
}

impl<C: Correction> Field for Corrected<C> {
    fn weights(&self) -> usize {
        self.base.weights() + self.correction.weights()
    }

    fn is_directed(&self) -> bool {
        self.base.friction
    }

    fn acceleration(&self, weights: &[f64], place: &Place) -> f64 {
        let (linear, own) = weights.split_at_checked(self.base.weights()).unwrap_or((weights, &[]));
        let z = self.base.scaled(place);
        let sum: f64 =
            linear.iter().zip(self.base.features(place, z)).map(|(weight, value)| weight * value).sum();
        self.base.known(place) + self.base.scale.acceleration * (sum + self.correction.value(own, z))
    }

    fn sloped(&self, weights: &[f64], place: &Place, slope: &mut Slope) -> f64 {
        let (linear, own) = weights.split_at_checked(self.base.weights()).unwrap_or((weights, &[]));
        let scale = &self.base.scale;
        let z = self.base.scaled(place);
        // Constant, position and velocity are always trained.
        let (Some((by_linear, by_own)), &[_, weight_x, weight_v, ..]) =
            (slope.weights.split_at_mut_checked(self.base.weights()), linear)
        else {
            return self.acceleration(weights, place);
        };
        let (value, [by_x, by_v]) = self.correction.sloped(own, z, by_own);
        by_own.iter_mut().for_each(|own| *own *= scale.acceleration);
        let mut sum = value;
        for ((slot, weight), feature) in by_linear.iter_mut().zip(linear).zip(self.base.features(place, z)) {
            *slot = scale.acceleration * feature;
            sum += weight * feature;
        }
        let [stiffness, damping, ..] = self.base.nominal;
        slope.position = scale.acceleration * (by_x + weight_x) / scale.position - stiffness;
        slope.velocity = scale.acceleration * (by_v + weight_v) / scale.velocity - damping;
        self.base.known(place) + scale.acceleration * sum
    }
}
