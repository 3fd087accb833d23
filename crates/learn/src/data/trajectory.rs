//! Trajectories: records, or stretches of records, as learners see them.

#![allow(clippy::indexing_slicing, reason = "the range is clipped to the samples")]

use crate::LearnError;

/// Positions over time, with an optional input.
///
/// Invariants, checked by [`Trajectory::new`]: every number is finite; times increase strictly (they may be
/// uneven); there is one position and, for a driven record, one input per time.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    name: String,
    times_s: Vec<f64>,
    values: Vec<f64>,
    input: Option<Vec<f64>>,
}

/// Returns the time from the first of some times to the last; 0 for fewer than two.
pub(crate) fn span_s(times_s: &[f64]) -> f64 {
    match times_s {
        [first, .., last] => last - first,
        _ => 0.0,
    }
}

impl Trajectory {
    /// Builds a trajectory from columns: times in seconds, positions in their unit, inputs in theirs.
    ///
    /// # Errors
    /// [`LearnError::UnequalColumns`], [`LearnError::NotFinite`], [`LearnError::TimeStands`], each with the
    /// sample.
    pub fn new(
        name: impl Into<String>,
        times_s: Vec<f64>,
        values: Vec<f64>,
        input: Option<Vec<f64>>,
    ) -> Result<Self, LearnError> {
        let name = name.into();
        let columns = [("time", Some(&times_s)), ("value", Some(&values)), ("input", input.as_ref())];
        for (column, found) in
            columns.iter().filter_map(|(column, found)| found.map(|found| (*column, found)))
        {
            if found.len() != times_s.len() {
                return Err(LearnError::UnequalColumns {
                    record: name,
                    column,
                    found: found.len(),
                    times: times_s.len(),
                });
            }
            if let Some((at, &value)) = found.iter().enumerate().find(|(_, value)| !value.is_finite()) {
                return Err(LearnError::NotFinite { record: name, column, value, sample: at + 1 });
            }
        }
        let pairs = times_s.iter().zip(times_s.iter().skip(1)).enumerate();
        if let Some((at, (&before, &time))) = pairs.into_iter().find(|(_, (before, time))| time <= before) {
            return Err(LearnError::TimeStands { record: name, time, before, sample: at + 2 });
        }
        Ok(Self { name, times_s, values, input })
    }

    /// Returns the name used in messages and tables.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the times in seconds, strictly increasing.
    #[must_use]
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// Returns the observed positions.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the input; `None` for a free motion.
    #[must_use]
    pub fn input(&self) -> Option<&[f64]> {
        self.input.as_deref()
    }

    /// Returns the number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.times_s.len()
    }

    /// Returns `true` if there are no samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.times_s.is_empty()
    }

    /// Returns the time from the first to the last sample, in seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        span_s(&self.times_s)
    }

    /// Returns the mean sample rate in Hz; 0 for fewer than two samples.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        if self.len() < 2 { 0.0 } else { (self.len() - 1) as f64 / self.duration_s() }
    }

    /// Returns the samples `from..to`, clipped to the samples that exist.
    #[must_use]
    pub fn part(&self, from: usize, to: usize) -> Self {
        let to = to.min(self.len());
        let from = from.min(to);
        let cut = |column: &[f64]| column[from..to].to_vec();
        Self {
            name: self.name.clone(),
            times_s: cut(&self.times_s),
            values: cut(&self.values),
            input: self.input.as_deref().map(cut),
        }
    }

    /// Returns the same trajectory under another name.
    #[must_use]
    pub fn named(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// Returns the number of samples within `seconds` of the first; at least one unless the trajectory is
    /// empty.
    #[must_use]
    pub fn samples_within(&self, seconds: f64) -> usize {
        let Some(first) = self.times_s.first() else { return 0 };
        let end = first + seconds * (1.0 + 1e-9);
        self.times_s.partition_point(|&time| time <= end)
    }

    /// Cuts the trajectory into consecutive pieces of about `seconds`. Each piece begins with the last sample
    /// of the previous one.
    #[must_use]
    pub fn pieces(&self, seconds: f64) -> Vec<Self> {
        let count = (self.duration_s() / seconds).round().max(1.0) as usize;
        let gaps = self.len().saturating_sub(1);
        let cut = |piece: usize| piece * gaps / count;
        (0..count)
            .map(|piece| self.part(cut(piece), cut(piece + 1) + 1))
            .filter(|piece| piece.len() > 3)
            .collect()
    }
}
