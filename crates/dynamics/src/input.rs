//! Measured input.

use crate::error::DynamicsError;
use serde::{Deserialize, Serialize};

/// Behavior of an input between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Hold {
    /// Keeps the last value, as a digital controller's output does.
    #[default]
    Zero,
    /// Changes linearly to the next value.
    Linear,
}

impl Hold {
    /// Returns the name in configurations and results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::Linear => "linear",
        }
    }

    /// Returns the behavior in words that follow "the input".
    #[must_use]
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Zero => "keeps its last sample",
            Self::Linear => "goes straight from sample to sample",
        }
    }
}

/// Measured input: values at times, and the behavior in between. Before the first time it has the first
/// value, after the last time the last one.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    times: Vec<f64>,
    values: Vec<f64>,
    hold: Hold,
}

/// Input on one piece: `value` at time `from`, changing by `slope` per second until `until`.
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
    /// Creates an input from its samples; times in seconds, values in the unit that the nominal `input_gain`
    /// converts to a torque.
    ///
    /// # Errors
    /// Returns [`DynamicsError::BadInput`] unless there is at least one sample, as many values as times, all
    /// are finite, and the times strictly increase.
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

    /// Returns the sample times in seconds, increasing; as many as [`Self::values`].
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Returns the sample values in the input's unit, before the nominal oscillator's gain.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the behavior between samples.
    #[must_use]
    pub fn hold(&self) -> Hold {
        self.hold
    }

    /// Returns the input with one knot in place of every `count` samples and straight lines between the
    /// knots. A `count` of 0 or 1 changes nothing.
    ///
    /// The values at the knots are those whose straight lines lie closest to the input over all of its time
    /// (least squares; the last sample gets no time). The remainder is orthogonal to straight lines over two
    /// knots. So a system that is slow in comparison moves the same way to fourth order in the distance of
    /// the knots; means over `count` samples agree to second order.
    ///
    /// ```
    /// use dynamics::{Hold, Input};
    /// let times: Vec<f64> = (0..61).map(|at| 0.1 * f64::from(at)).collect();
    /// let input = Input::new(times.clone(), times.iter().map(|t| t.sin()).collect(), Hold::Linear)?;
    /// let thinned = input.thinned(4);
    /// assert_eq!(thinned.times().len(), 16);
    /// for (time, value) in thinned.times().iter().zip(thinned.values()) {
    ///     assert!((value - time.sin()).abs() < 0.02);
    /// }
    /// # Ok::<(), dynamics::DynamicsError>(())
    /// ```
    #[must_use]
    pub fn thinned(&self, count: usize) -> Self {
        if count < 2 || self.times.len() < 2 {
            return self.clone();
        }
        let times: Vec<f64> = self.times.iter().copied().step_by(count).collect();
        // Normal equations: the diagonal, the entries beside it, and the right side.
        let mut diagonal = vec![0.0; times.len()];
        let mut beside = vec![0.0; times.len()];
        let mut values = vec![0.0; times.len()];
        let ends = self.times.iter().zip(&self.values).skip(1);
        for ((number, (&from, &value)), (&until, &next)) in
            self.times.iter().zip(&self.values).enumerate().zip(ends)
        {
            let knot = number / count;
            let part = |time: f64| match times.get(knot..) {
                Some(&[before, after, ..]) => (time - before) / (after - before),
                _ => 0.0,
            };
            let length = until - from;
            // Integral of the product of two functions that are linear over the piece.
            let product =
                |[a, b]: [f64; 2], [c, d]: [f64; 2]| length / 6.0 * (2.0 * (a * c + b * d) + a * d + b * c);
            let after = [part(from), part(until)];
            let before = after.map(|part| 1.0 - part);
            let own = [value, if self.hold == Hold::Zero { value } else { next }];
            for (at, weight) in [(knot, before), (knot + 1, after)] {
                if let (Some(square), Some(right)) = (diagonal.get_mut(at), values.get_mut(at)) {
                    *square += product(weight, weight);
                    *right += product(weight, own);
                }
            }
            if let Some(coupling) = beside.get_mut(knot) {
                *coupling += product(before, after);
            }
        }
        solve_symmetric_tridiagonal(&mut diagonal, &beside, &mut values);
        Self { times, values, hold: Hold::Linear }
    }

    /// Returns the piece that begins at sample `index − 1` and ends at sample `index`; 0 is the piece before
    /// the first.
    pub(crate) fn piece(&self, index: usize) -> Piece {
        let at = |list: &[f64], index: usize| list.get(index).copied();
        let until = at(&self.times, index).unwrap_or(f64::INFINITY);
        let Some(from) = index.checked_sub(1).and_then(|before| at(&self.times, before)) else {
            // An input without samples drives nothing.
            let value = at(&self.values, 0).unwrap_or(0.0);
            return Piece { from: f64::NEG_INFINITY, value, slope: 0.0, until };
        };
        debug_assert_eq!(self.times.len(), self.values.len(), "an input has a value for every time");
        // The value exists: the sample's time was found above.
        let value = at(&self.values, index - 1).unwrap_or(0.0);
        let slope = match (self.hold, at(&self.values, index)) {
            (Hold::Linear, Some(next)) => (next - value) / (until - from),
            _ => 0.0,
        };
        Piece { from, value, slope, until }
    }

    /// Returns the index of the piece that holds just after a time.
    pub(crate) fn piece_index(&self, time: f64) -> usize {
        self.times.partition_point(|&knot| knot <= time)
    }
}

/// Solves a positive definite system in place by elimination without pivots. `beside[i]` couples the unknowns
/// i and i + 1; `diagonal` is overwritten.
fn solve_symmetric_tridiagonal(diagonal: &mut [f64], beside: &[f64], values: &mut [f64]) {
    debug_assert!(
        diagonal.len() == values.len() && diagonal.len() == beside.len(),
        "one row for each unknown"
    );
    let mut before: Option<(f64, f64, f64)> = None;
    for ((own, value), next) in diagonal.iter_mut().zip(values.iter_mut()).zip(beside) {
        if let Some((pivot, known, coupling)) = before {
            *own -= coupling * coupling / pivot;
            *value -= coupling / pivot * known;
        }
        before = Some((*own, *value, *next));
    }
    let mut after: Option<f64> = None;
    for ((own, value), next) in diagonal.iter().zip(values.iter_mut()).zip(beside).rev() {
        // The last unknown has none after it.
        *value = (*value - next * after.unwrap_or(0.0)) / own;
        after = Some(*value);
    }
}

#[cfg(test)]
mod tests {
    use super::{Hold, Input};

    /// A straight line stays one; with zero-order hold it is the line through the middles of its steps.
    #[test]
    fn fewer_samples_of_a_straight_line_lie_on_it() {
        let times: Vec<f64> = (0..10).map(f64::from).collect();
        for (hold, ahead) in [(Hold::Linear, 0.0), (Hold::Zero, -0.5)] {
            let line = Input::new(times.clone(), times.clone(), hold).unwrap().thinned(3);
            assert_eq!(line.times(), [0.0, 3.0, 6.0, 9.0]);
            for (time, value) in line.times().iter().zip(line.values()).take(3) {
                assert!(
                    (value - time - ahead).abs() < if hold == Hold::Zero { 0.1 } else { 1e-12 },
                    "{time} {value}"
                );
            }
        }
    }

    /// The response of a slow system to a sine is its product with smooth bumps. It differs by the fourth
    /// power of the knots' distance: sixteen times as much at twice the distance.
    #[test]
    fn a_slow_system_feels_the_same() {
        let times: Vec<f64> = (0..4001).map(|at| 1e-3 * f64::from(at)).collect();
        let sine: Vec<f64> = times.iter().map(|t| (40.0 * t).sin()).collect();
        let felt = |input: &Input| -> f64 {
            let of = |time: f64| {
                let at = input.times().partition_point(|knot| *knot <= time);
                input.piece(at).at(time) * (-(time - 2.0).powi(2) / 0.02).exp() * (40.0 * time).sin()
            };
            // In the middle of each tenth of a piece: at its jumps a held input has no value.
            (0..40_000).map(|at| of(1e-4 * (f64::from(at) + 0.5))).sum::<f64>() * 1e-4
        };
        for hold in [Hold::Linear, Hold::Zero] {
            let input = Input::new(times.clone(), sine.clone(), hold).unwrap();
            let error = |count: usize| (felt(&input.thinned(count)) / felt(&input) - 1.0).abs();
            let (near, far) = (error(10), error(20));
            assert!(near < 1e-4 && (12.0..20.0).contains(&(far / near)), "{hold:?} {near} {far}");
        }
    }
}
