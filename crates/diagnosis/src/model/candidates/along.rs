//! A fitted motion, as a candidate sees it that asks what it would add.

use crate::data::scales::Scales;
use dynamics::{Coefficients, Hold, Input, MOST_HIDDEN, MOST_PARAMETERS, Moment, SystemEffect, Values};

/// A motion on one segment, with the response of what is observed to small torques along it.
///
/// All series have one entry for each sample.
pub(crate) struct Along<'a> {
    /// Times in seconds.
    pub(crate) times: &'a [f64],
    /// Position in rad or m, and its derivatives' first.
    pub(crate) position: &'a [f64],
    pub(crate) velocity: &'a [f64],
    /// The observed quantity and its time derivative; the derivative is empty for accelerations.
    pub(crate) observed: &'a [f64],
    pub(crate) rate: &'a [f64],
    /// Torque of the input.
    pub(crate) input: &'a [f64],
    /// The input itself; none without one.
    pub(crate) command: Option<&'a Input>,
    /// Whether the segment begins the record.
    pub(crate) first: bool,
    pub(crate) facts: &'a Scales,
    pub(crate) nominal: &'a Coefficients<f64>,
    /// Response of the observed quantity to a torque given at the samples, from rest.
    pub(crate) respond: &'a dyn Fn(&[f64]) -> Vec<f64>,
}

impl Along<'_> {
    /// Response of the observed quantity to the torque of an effect with some values.
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

    /// The moment that a law sees at a sample, in its first region.
    pub(crate) fn moment(&self, index: usize) -> Moment<f64> {
        // Every series has an entry for each sample.
        let at = |list: &[f64]| list.get(index).copied().unwrap_or(0.0);
        let velocity = at(self.velocity);
        Moment {
            time: at(self.times),
            position: at(self.position),
            velocity,
            input: at(self.input),
            hidden: [0.0; MOST_HIDDEN],
            nominal: *self.nominal,
            direction: if velocity < 0.0 { -1.0 } else { 1.0 },
            region: 0,
        }
    }
}

/// The input at a time.
pub(crate) fn held(input: &Input, time: f64) -> f64 {
    let at = input.times().partition_point(|knot| *knot <= time);
    let value = |index: usize| input.values().get(index).copied();
    let knot = |index: usize| input.times().get(index).copied();
    // An input without values does nothing.
    let Some(before) = at.checked_sub(1) else { return value(0).unwrap_or(0.0) };
    // It has a value at every knot.
    let low = value(before).unwrap_or(0.0);
    match (input.hold(), value(at), knot(before), knot(at)) {
        (Hold::Linear, Some(high), Some(from), Some(to)) => low + (high - low) * (time - from) / (to - from),
        _ => low,
    }
}

/// What the residual of a fit shows at a glance: where candidates begin whose frequency no grid would hit.
pub(crate) trait Lines {
    /// Angular frequencies of the strongest steady lines, in rad/s, the strongest first.
    fn steady(&self, most: usize) -> Vec<f64>;

    /// The strongest lines that decay from each segment's beginning, the strongest first.
    fn decaying(&self, most: usize) -> Vec<Mode>;

    /// The second bodies on a spring that would take away most of the residual of driven records, the best first; none
    /// without an input.
    fn driven(&self, most: usize) -> Vec<Mode>;

    /// Length of the longest segment in seconds.
    fn longest_span(&self) -> f64;
}

/// A mode that a residual shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mode {
    /// Angular frequency in rad/s.
    pub(crate) frequency: f64,
    /// Decay rate in 1/s.
    pub(crate) rate: f64,
    /// Inertia of the body that would cause it; none where the line alone does not tell.
    pub(crate) inertia: Option<f64>,
    /// What it would take away of the squares.
    pub(crate) gain: f64,
}

/// An effect's values, filled up to the length that laws take.
pub(crate) fn padded(values: &[f64]) -> Values<f64> {
    let mut all = [0.0; MOST_PARAMETERS];
    for (slot, value) in all.iter_mut().zip(values) {
        *slot = *value;
    }
    all
}
