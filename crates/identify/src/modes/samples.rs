//! Samples of a record, scaled for a search of modes.

use record::{Clock, Record};
use std::f64::consts::TAU;

/// Fewest samples with modes.
const FEWEST_SAMPLES: usize = 32;
/// Samples per period that are enough for a search.
const ENOUGH_PER_PERIOD: f64 = 10.0;

/// Times from 0 to 1 and values minus their mean over their standard deviation.
pub(super) struct Samples {
    pub(super) times: Vec<f64>,
    pub(super) values: Vec<f64>,
    pub(super) duration_s: f64,
    /// Standard deviation of the values, in the record's unit.
    pub(super) size: f64,
}

impl Samples {
    pub(super) fn new(record: &Record, clock: &Clock) -> Option<Self> {
        let (first, last) = (*clock.times_s.first()?, *clock.times_s.last()?);
        let (values, count) = (record.values(), record.len() as f64);
        let duration_s = last - first;
        let mean = values.iter().sum::<f64>() / count;
        let size = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
        let usable = values.len() >= FEWEST_SAMPLES && duration_s > 0.0 && size.is_finite();
        // Rounding leaves a deviation to values that are all the same.
        (usable && size > 1e-12 * mean.abs() && size > 0.0).then(|| Self {
            times: clock.times_s.iter().map(|time| (time - first) / duration_s).collect(),
            values: values.iter().map(|value| (value - mean) / size).collect(),
            duration_s,
            size,
        })
    }

    /// Returns the means of as many neighbors as a highest angular frequency allows; no mean spans a gap.
    pub(super) fn thinned(&self, omega: f64) -> Self {
        let step = 1.0 / self.times.len() as f64;
        let together = (TAU / omega / step / ENOUGH_PER_PERIOD).floor().clamp(1.0, 1e6);
        let (mut times, mut values) = (Vec::new(), Vec::new());
        let (mut start, mut sums, mut count) = (f64::NEG_INFINITY, (0.0, 0.0), 0.0);
        for (&time, &value) in self.times.iter().zip(&self.values) {
            if count >= together || (count > 0.0 && time - start > 1.5 * together * step) {
                times.push(sums.0 / count);
                values.push(sums.1 / count);
                (sums, count) = ((0.0, 0.0), 0.0);
            }
            if count == 0.0 {
                start = time;
            }
            sums = (sums.0 + time, sums.1 + value);
            count += 1.0;
        }
        if count >= 0.5 * together {
            times.push(sums.0 / count);
            values.push(sums.1 / count);
        }
        Self { times, values, duration_s: self.duration_s, size: self.size }
    }
}
