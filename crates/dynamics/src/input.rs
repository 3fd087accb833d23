//! The measured input.

use crate::error::DynamicsError;
use serde::{Deserialize, Serialize};

/// Behavior of an input between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Hold {
    /// It keeps the last value, as a digital controller's output does.
    #[default]
    Zero,
    /// It goes straight to the next value.
    Linear,
}

/// A measured input: values at times, and what happens in between. Before the first time it has the first
/// value, after the last the last.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    times: Vec<f64>,
    values: Vec<f64>,
    hold: Hold,
}

/// The input on one piece: `value` at time `from`, changing by `slope` per second until `until`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Piece {
    pub(crate) from: f64,
    pub(crate) value: f64,
    pub(crate) slope: f64,
    pub(crate) until: f64,
}

impl Piece {
    pub(crate) fn at(&self, time: f64) -> f64 {
        if self.slope == 0.0 { self.value } else { self.value + self.slope * (time - self.from) }
    }
}

impl Input {
    /// An input from its samples; times in seconds, values in the unit that the nominal `input_gain` turns
    /// into a torque.
    ///
    /// # Errors
    /// [`DynamicsError::BadInput`] unless there is at least one sample, as many values as times, all
    /// finite, and the times strictly increase.
    pub fn new(times: Vec<f64>, values: Vec<f64>, hold: Hold) -> Result<Self, DynamicsError> {
        let bad = |what, index, value, remedy| Err(DynamicsError::BadInput { what, index, value, remedy });
        if times.is_empty() || times.len() != values.len() {
            return bad(
                "number of values",
                values.len(),
                times.len() as f64,
                "give one value for each time, at least one",
            );
        }
        if let Some((index, &value)) = values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
            return bad("value", index, value, "values must be finite");
        }
        if let Some((index, &time)) = times.iter().enumerate().find(|(_, time)| !time.is_finite()) {
            return bad("time", index, time, "times must be finite");
        }
        let pairs = times.iter().zip(times.iter().skip(1));
        if let Some((index, (_, &time))) = pairs.enumerate().find(|(_, (before, after))| after <= before) {
            return bad("time", index + 1, time, "times must strictly increase");
        }
        Ok(Self { times, values, hold })
    }

    /// Sample times in seconds, increasing; as many as [`Self::values`].
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Sample values in the input's unit, before the nominal oscillator's gain.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Behavior between samples.
    #[must_use]
    pub fn hold(&self) -> Hold {
        self.hold
    }

    /// Averages the input to one sample for every `count`, which keeps its integral where the samples are evenly spaced: the
    /// mean over so many where it is held, and, where it goes straight on, the mean weighted by the distance from the new
    /// sample, falling to none at the next. A `count` of 0 or 1 changes nothing.
    ///
    /// ```
    /// use dynamics::{Hold, Input};
    /// let times = (0..4).map(f64::from).collect();
    /// let input = Input::new(times, vec![1.0, 3.0, 2.0, 6.0], Hold::Zero)?;
    /// assert_eq!(input.averaged(2).times(), [0.0, 2.0]);
    /// assert_eq!(input.averaged(2).values(), [2.0, 4.0]);
    /// # Ok::<(), dynamics::DynamicsError>(())
    /// ```
    #[must_use]
    pub fn averaged(&self, count: usize) -> Self {
        let count = count.max(1);
        let mean = |from: usize| {
            let before = if self.hold == Hold::Linear { count - 1 } else { 0 };
            let first = from.saturating_sub(before);
            let own = self.values.iter().enumerate().skip(first).take(from + count - first);
            let (mut sum, mut weights) = (0.0, 0.0);
            for (index, value) in own {
                let weight = match self.hold {
                    Hold::Zero => 1.0,
                    Hold::Linear => 1.0 - index.abs_diff(from) as f64 / count as f64,
                };
                sum += weight * value;
                weights += weight;
            }
            sum / weights
        };
        Self {
            times: self.times.iter().copied().step_by(count).collect(),
            values: (0..self.values.len()).step_by(count).map(mean).collect(),
            hold: self.hold,
        }
    }

    /// The piece that begins at sample `index − 1` and ends at sample `index`; 0 is the piece before the first.
    pub(crate) fn piece(&self, index: usize) -> Piece {
        let at = |list: &[f64], index: usize| list.get(index).copied();
        let until = at(&self.times, index).unwrap_or(f64::INFINITY);
        let Some(from) = index.checked_sub(1).and_then(|before| at(&self.times, before)) else {
            // An input without samples drives nothing.
            let value = at(&self.values, 0).unwrap_or(0.0);
            return Piece { from: f64::NEG_INFINITY, value, slope: 0.0, until };
        };
        debug_assert_eq!(self.times.len(), self.values.len(), "an input has a value for every time");
        // There is one: the sample's time was found above.
        let value = at(&self.values, index - 1).unwrap_or(0.0);
        let slope = match (self.hold, at(&self.values, index)) {
            (Hold::Linear, Some(next)) => (next - value) / (until - from),
            _ => 0.0,
        };
        Piece { from, value, slope, until }
    }

    /// Index of the piece that holds just after a time.
    pub(crate) fn piece_index(&self, time: f64) -> usize {
        self.times.partition_point(|&knot| knot <= time)
    }
}

#[cfg(test)]
mod tests {
    use super::{Hold, Input};

    /// A straight line stays one, and so does its integral.
    #[test]
    fn fewer_samples_of_a_straight_line_lie_on_it() {
        let times: Vec<f64> = (0..9).map(f64::from).collect();
        let line = Input::new(times.clone(), times, Hold::Linear).unwrap().averaged(4);
        assert_eq!(line.times(), [0.0, 4.0, 8.0]);
        assert!((line.values()[1] - 4.0).abs() < 1e-12);
    }
}
