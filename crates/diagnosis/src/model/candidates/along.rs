//! Fitted motion, in the form that a candidate reads to compute its first-order change.

#![allow(clippy::indexing_slicing, reason = "all series of a path have an entry for every sample")]

use crate::data::scales::Scales;
use dynamics::{Coefficients, Input, MOST_HIDDEN, MOST_PARAMETERS, Moment, SystemEffect, Values};

/// Motion on one segment, with the response of the observed quantity to small torques along it.
///
/// All series have one entry for each sample.
pub(crate) struct Along<'a> {
    /// Times in seconds.
    pub(crate) times: &'a [f64],
    /// Position in rad or m, and the velocity, its first derivative.
    pub(crate) position: &'a [f64],
    pub(crate) velocity: &'a [f64],
    /// Observed quantity and its time derivative; the derivative is empty for accelerations.
    pub(crate) observed: &'a [f64],
    pub(crate) rate: &'a [f64],
    /// Torque of the input, and its rate.
    pub(crate) input: &'a [f64],
    pub(crate) input_rate: &'a [f64],
    /// Input itself; `None` for a free swing.
    pub(crate) command: Option<&'a Input>,
    /// `true` if the segment is at the start of the record.
    pub(crate) first: bool,
    pub(crate) facts: &'a Scales,
    pub(crate) nominal: &'a Coefficients<f64>,
    /// Response of the observed quantity to a torque given at the samples, from rest.
    pub(crate) respond: &'a dyn Fn(&[f64]) -> Vec<f64>,
}

impl Along<'_> {
    /// Returns the response of the observed quantity to the torque of an effect with some values.
    pub(crate) fn response_to(&self, effect: SystemEffect, values: &[f64]) -> Vec<f64> {
        let own = padded(values);
        let torque = |index| {
            let mut moment = self.moment(index);
            moment.region = effect.region(&own, &moment);
            effect.torque(&own, &moment)
        };
        let torques: Vec<f64> = (0..self.times.len()).map(torque).collect();
        (self.respond)(&torques)
    }

    /// Returns the moment that a law reads at a sample, in its first region.
    pub(crate) fn moment(&self, index: usize) -> Moment<f64> {
        let velocity = self.velocity[index];
        Moment {
            time: self.times[index],
            position: self.position[index],
            velocity,
            input: self.input[index],
            input_rate: self.input_rate[index],
            hidden: [0.0; MOST_HIDDEN],
            nominal: *self.nominal,
            direction: if velocity < 0.0 { -1.0 } else { 1.0 },
            region: 0,
        }
    }
}

/// Lines in the residual of a fit, at which candidates with a frequency begin, since no grid would hit it.
pub(crate) trait Lines {
    /// Returns the angular frequencies of the strongest steady lines, in rad/s, the strongest first.
    fn steady(&self, most: usize) -> Vec<f64>;

    /// Returns the strongest lines that decay from each segment's start, the strongest first.
    fn decaying(&self, most: usize) -> Vec<Mode>;

    /// Returns the second bodies on a spring that would explain most of the residual of driven records, the
    /// best first; empty without an input.
    fn driven(&self, most: usize) -> Vec<Mode>;

    /// Returns the length of the longest segment in seconds.
    fn longest_span(&self) -> f64;
}

/// Mode that a residual shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mode {
    /// Angular frequency in rad/s.
    pub(crate) frequency: f64,
    /// Decay rate in 1/s.
    pub(crate) rate: f64,
    /// Inertia of the body that would cause the mode; `None` if the line alone does not determine it.
    pub(crate) inertia: Option<f64>,
    /// Decrease of the squares that the mode would bring.
    pub(crate) gain: f64,
}

/// Returns the torque of an input at some times, and its rate; zeros without an input. `gain` is the torque per unit of
/// the input.
pub(crate) fn driven(input: Option<&Input>, gain: f64, times: &[f64]) -> [Vec<f64>; 2] {
    let along = |of: fn(&Input, f64) -> f64| match input {
        Some(input) => times.iter().map(|time| gain * of(input, *time)).collect(),
        None => vec![0.0; times.len()],
    };
    [along(Input::at), along(Input::rate_at)]
}

/// Pads an effect's values to the length that laws take.
pub(crate) fn padded(values: &[f64]) -> Values<f64> {
    let mut all = [0.0; MOST_PARAMETERS];
    for (slot, value) in all.iter_mut().zip(values) {
        *slot = *value;
    }
    all
}
