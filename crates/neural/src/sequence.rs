//! Input of the networks: an envelope's peaks as a sequence in scaled units.

use envelope::Envelope;
use estimator::{FitContext, Scaling};

/// Sequence that an encoder reads: peaks, or means of neighboring peaks, in scaled units.
///
/// Times s run from −1 to 1 over the record; values z have mean 0 and standard deviation 1 over the peaks.
#[derive(Debug, Clone, PartialEq)]
pub struct Sequence {
    /// Scaled times, increasing.
    pub times: Vec<f64>,
    /// Scaled ln A.
    pub values: Vec<f64>,
}

impl Sequence {
    /// Returns the peaks of an envelope in scaled units.
    #[must_use]
    pub fn of(envelope: &Envelope, scaling: &Scaling) -> Self {
        Self { times: scaling.centered_times(envelope), values: scaling.scaled_logs(envelope) }
    }

    /// Returns the number of entries.
    #[must_use]
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// Returns the number of entries of each of several sequences, which are equally long; 0 without any.
    #[must_use]
    pub fn length(sequences: &[Self]) -> usize {
        let length = sequences.first().map_or(0, Self::len);
        debug_assert!(sequences.iter().all(|own| own.len() == length));
        length
    }

    /// Returns `true` if there are no entries.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// Returns the mean time between entries; 1 for fewer than two entries.
    #[must_use]
    pub fn mean_interval(&self) -> f64 {
        match (self.times.first(), self.times.last()) {
            (Some(first), Some(last)) if self.len() > 1 => (last - first) / (self.len() - 1) as f64,
            _ => 1.0,
        }
    }

    /// Returns the sequence as a network sees it: unchanged, or replaced by white noise if an
    /// [ablation](FitContext::input) requests it.
    #[must_use]
    pub fn as_read(self, context: &FitContext<'_>) -> Self {
        Self { times: context.input("times", self.times), values: context.input("amplitudes", self.values) }
    }

    /// Pools the sequence to at most `most` entries: means of times and values over runs of neighbors, with
    /// lengths as equal as possible. A shorter sequence stays unchanged.
    #[must_use]
    pub fn pooled(self, most: usize) -> Self {
        let (count, runs) = (self.len(), most.max(1));
        if count <= runs {
            return self;
        }
        let means = |entries: &[f64]| -> Vec<f64> {
            (0..runs)
                .filter_map(|run| entries.get(run * count / runs..(run + 1) * count / runs))
                .map(|part| part.iter().sum::<f64>() / part.len() as f64)
                .collect()
        };
        Self { times: means(&self.times), values: means(&self.values) }
    }
}

#[cfg(test)]
mod tests {
    use super::Sequence;
    use envelope::Envelope;
    use estimator::Scaling;

    #[test]
    fn a_long_sequence_is_read_as_means_over_even_runs() {
        let times = vec![-1.0, -0.4, 0.0, 0.5, 1.0];
        let sequence = Sequence { times, values: vec![1.0, 2.0, 4.0, 8.0, 16.0] };
        assert_eq!(sequence.clone().pooled(5), sequence);
        // Five entries in two runs: two and three.
        let pooled = sequence.pooled(2);
        assert_eq!(pooled.values, [1.5, 28.0 / 3.0]);
        assert_eq!(pooled.times, [-0.7, 0.5]);
        let long = Sequence { times: vec![0.0; 100_000], values: vec![3.0; 100_000] };
        assert_eq!(long.pooled(999).values, [3.0; 999]);
    }

    #[test]
    fn scaled_units_are_what_they_are_said_to_be() {
        let envelope = Envelope::new(vec![5.0, 6.0, 9.0], vec![3.0, 2.0, -2.0], 6.0).unwrap();
        let scaling = Scaling::of(&envelope).unwrap();
        let scaled = Sequence::of(&envelope, &scaling);
        assert_eq!(scaled.times, [-1.0, -0.5, 1.0]);
        assert!(scaled.values.iter().sum::<f64>().abs() < 1e-15);
        let squares: f64 = scaled.values.iter().map(|z| z * z).sum();
        assert!((squares / 3.0 - 1.0).abs() < 1e-15);
        assert_eq!(scaled.mean_interval(), 1.0);
        // z = c − r·s is ln A = ln A₀ − λ·t, where λ is the rate r in physical units.
        let [at_start, at_end] = [-1.0, 1.0].map(|s| scaling.log_amplitude(0.3 - 0.7 * s));
        assert!((at_start - 4.0 * scaling.rate_per_centered_time(0.7) - at_end).abs() < 1e-14);
    }
}
