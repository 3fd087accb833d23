//! One record, or a stretch of it, as learners see it.

use crate::LearnError;

/// Positions over time, with the input where there is one.
///
/// Invariants, checked when it is made: every number finite, times strictly increasing (they may be uneven), one value
/// and, where there is an input, one input for each time.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    name: String,
    times_s: Vec<f64>,
    values: Vec<f64>,
    input: Option<Vec<f64>>,
}

impl Trajectory {
    /// Makes a trajectory from columns: times in seconds, values in the unit of the position, inputs in their own.
    ///
    /// # Errors
    /// [`LearnError::UnequalColumns`], [`LearnError::NotFinite`], [`LearnError::TimeStands`], each with the place.
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

    /// Name for messages and tables.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Times in seconds, strictly increasing.
    #[must_use]
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// Observed positions.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The input, where there is one.
    #[must_use]
    pub fn input(&self) -> Option<&[f64]> {
        self.input.as_deref()
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.times_s.len()
    }

    /// Whether there are no samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.times_s.is_empty()
    }

    /// Time from the first to the last sample, in seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        // Of no sample no time passes.
        self.times_s.first().zip(self.times_s.last()).map_or(0.0, |(first, last)| last - first)
    }

    /// Mean samples per second; 0 for fewer than two samples.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        if self.len() < 2 { 0.0 } else { (self.len() - 1) as f64 / self.duration_s() }
    }

    /// The samples `from..to`, as many of them as there are.
    #[must_use]
    pub fn part(&self, from: usize, to: usize) -> Self {
        let to = to.min(self.len());
        let from = from.min(to);
        // The range was cut to what there is.
        let cut = |column: &[f64]| column.get(from..to).unwrap_or_default().to_vec();
        Self {
            name: self.name.clone(),
            times_s: cut(&self.times_s),
            values: cut(&self.values),
            input: self.input.as_deref().map(cut),
        }
    }

    /// The same trajectory under another name.
    #[must_use]
    pub fn named(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// Number of samples within `seconds` of the first, at least one where there is any.
    #[must_use]
    pub fn samples_within(&self, seconds: f64) -> usize {
        // Of no sample none lies within.
        let end = self.times_s.first().copied().unwrap_or_default() + seconds * (1.0 + 1e-9);
        self.times_s.partition_point(|&time| time <= end)
    }

    /// Consecutive pieces of about `seconds`, each beginning with the last sample of the one before.
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
