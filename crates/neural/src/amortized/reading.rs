//! Reading of envelopes by a trained network.

use super::bank::Standardized;
use super::mirror::SAID;
use super::mirror::{agreed, both_ways};
use super::training::Training;
use crate::decay::Encoder;
use crate::device::values;
use crate::sequence::Sequence;
use burn::tensor::Device;
use estimator::FitError;

/// Line that a network reads from a sequence: z ≈ level − rate·s, in the units of the sequence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reading {
    pub(super) level: f64,
    pub(super) rate: f64,
    /// Standard errors of level and rate, as stated at the last look.
    pub(super) level_std_error: f64,
    pub(super) rate_std_error: f64,
    pub(super) looks: usize,
    /// Change of the rate at the last look, in stated standard errors.
    pub(super) moved: f64,
    /// `true` if the residual at the last look was only rounding errors.
    pub(super) exact: bool,
}

/// Change of the rate at a look, in stated standard errors, below which the reading has settled.
const SETTLED: f64 = 0.01;

/// Number of looks whose answer is applied in full; later ones are halved.
///
/// If a reading has not settled by then, the network overestimates alternately in both directions. Half steps
/// end this oscillation at the same fixed point.
const FULL_LOOKS: usize = 10;

/// Standard deviation of the residual, relative to that of the original sequence, at which rounding errors
/// dominate.
const ROUNDING: f64 = 1e-13;

impl Reading {
    const NONE: Self = Self {
        level: 0.0,
        rate: 0.0,
        level_std_error: 0.0,
        rate_std_error: 0.0,
        looks: 0,
        moved: f64::INFINITY,
        exact: false,
    };

    /// Returns `true` if another look would not change the answer.
    pub(super) fn is_settled(&self) -> bool {
        self.exact || self.moved <= SETTLED
    }

    /// Returns the residual of a sequence about the line.
    fn left_of(&self, peaks: &Sequence) -> Sequence {
        let pairs = peaks.times.iter().zip(&peaks.values);
        let values = pairs.map(|(s, z)| z - (self.level - self.rate * s)).collect();
        Sequence { times: peaks.times.clone(), values }
    }

    /// Updates the reading with the network's output for a look.
    fn learn(&mut self, seen: &Standardized, [level, rate, level_variance, rate_variance]: [f64; SAID]) {
        let entries = seen.sequence.len() as f64;
        let std_error = |log_variance: f64| (log_variance.exp() / entries).sqrt();
        let share = if self.looks < FULL_LOOKS { 1.0 } else { 0.5 };
        self.level += seen.mean + share * seen.spread * level;
        self.rate += share * seen.spread * rate;
        self.level_std_error = seen.spread * std_error(level_variance);
        self.rate_std_error = seen.spread * std_error(rate_variance);
        self.moved = rate.abs() / std_error(rate_variance);
        self.looks += 1;
    }

    /// Returns the variance of a peak's z about the line, with peaks − 2 degrees of freedom.
    pub(super) fn scatter_variance(&self, peaks: &Sequence) -> f64 {
        let squares: f64 = self.left_of(peaks).values.iter().map(|left| left * left).sum();
        squares / (peaks.len() as f64 - 2.0)
    }
}

impl Training {
    /// Reads a sequence; looks until the answer no longer changes.
    pub(super) fn read<E: Encoder>(
        &self,
        encoder: &E,
        peaks: &Sequence,
        device: &Device,
    ) -> Result<Reading, FitError> {
        let readings = self.read_all(encoder, std::slice::from_ref(peaks), device)?;
        readings
            .first()
            .copied()
            .ok_or_else(|| FitError::Backend { problem: "one sequence gave no reading".to_owned() })
    }

    /// Reads sequences of equal length; looks at all of them until none changes.
    pub(super) fn read_all<E: Encoder>(
        &self,
        encoder: &E,
        sequences: &[Sequence],
        device: &Device,
    ) -> Result<Vec<Reading>, FitError> {
        let mut readings = vec![Reading::NONE; sequences.len()];
        let mut first_spreads = Vec::new();
        for _ in 0..self.most_looks {
            let pairs = readings.iter().zip(sequences);
            let seen: Vec<Standardized> = pairs
                .map(|(reading, peaks)| Standardized::of(reading.left_of(peaks), self.longest_sequence))
                .collect();
            if first_spreads.is_empty() {
                first_spreads.extend(seen.iter().map(|seen| seen.spread));
            }
            let said = say(encoder, &seen, device)?;
            let looks = seen.iter().zip(said).zip(&first_spreads);
            for (reading, ((seen, said), first_spread)) in readings.iter_mut().zip(looks) {
                reading.learn(seen, said);
                reading.exact = seen.spread <= ROUNDING * first_spread;
            }
            if readings.iter().all(Reading::is_settled) {
                break;
            }
        }
        Ok(readings)
    }
}

/// Returns the network's outputs for standardized sequences.
fn say<E: Encoder>(
    encoder: &E,
    seen: &[Standardized],
    device: &Device,
) -> Result<Vec<[f64; SAID]>, FitError> {
    let sequences = both_ways(seen.iter().map(|seen| &seen.sequence));
    let said = values(agreed(encoder.encode(encoder.input(&sequences, device))))?;
    let (said, rest) = said.as_chunks::<SAID>();
    if said.len() == seen.len() && rest.is_empty() {
        Ok(said.to_vec())
    } else {
        let problem = format!("a network that does not say {SAID} numbers of a sequence");
        Err(FitError::Backend { problem })
    }
}

#[cfg(test)]
mod tests {
    use crate::amortized::estimator::Skilled;
    use crate::amortized::mirror::SAID;
    use crate::amortized::tiny::{Tiny, estimator};
    use crate::device::device;
    use crate::flat::with_parameters;
    use crate::sequence::Sequence;

    /// Builds a reader that returns this share of the rate that it sees, level 0, and variances e^0.2 and
    /// e^0.5 per entry.
    fn reader(share: f64) -> Tiny {
        let device = device().unwrap();
        // For even times, Σ s² is nearly a third of the number of entries; rates have the opposite sign.
        let weights = [0.0, -3.0 * share, 0.0, 0.0, 0.0, 0.0, 0.2, 0.5];
        with_parameters(estimator().network.encoder(SAID, &device), &weights, &device).unwrap()
    }

    fn sequence(steeper: f64) -> Sequence {
        let times: Vec<f64> = (0..21).map(|at| f64::from(at) / 10.0 - 1.0).collect();
        let value = |(at, s): (usize, &f64)| 2.0 - steeper * s + 0.3 * (7.0 * at as f64).sin();
        Sequence { values: times.iter().enumerate().map(value).collect(), times }
    }

    #[test]
    fn it_looks_until_nothing_is_left_to_see() {
        let device = device().unwrap();
        let training = estimator().training;
        let peaks = sequence(5.0);
        let reading = training.read(&reader(0.7), &peaks, &device).unwrap();
        assert!(reading.is_settled() && reading.looks > 3, "{reading:?}");
        // At the settled answer, s and the residual are orthogonal, to the accuracy of settling.
        let left = reading.left_of(&peaks);
        let along: f64 = left.times.iter().zip(&left.values).map(|(s, z)| s * z).sum();
        assert!(along.abs() < 0.02, "{along}");
        let spread = (left.values.iter().map(|z| z * z).sum::<f64>() / 21.0).sqrt();
        let stated = spread * (0.5_f64.exp() / 21.0).sqrt();
        assert!((reading.rate_std_error / stated - 1.0).abs() < 1e-3, "{reading:?}");
        assert!((reading.scatter_variance(&peaks) - spread * spread * 21.0 / 19.0).abs() < 1e-12);
    }

    #[test]
    fn an_added_rate_is_added_and_told_backward_it_is_the_opposite() {
        let device = device().unwrap();
        let training = estimator().training;
        let rate = |peaks: &Sequence| training.read(&reader(0.9), peaks, &device).unwrap().rate;
        let slow = rate(&sequence(0.4));
        assert!((rate(&sequence(40.4)) - slow - 40.0).abs() < 2e-3);
        let peaks = sequence(0.4);
        let values = peaks.values.iter().rev().copied().collect();
        let backward = Sequence { times: peaks.times.iter().rev().map(|s| -s).collect(), values };
        assert!((rate(&backward) + slow).abs() < 1e-14);
    }

    #[test]
    fn a_line_is_read_to_rounding_and_a_constant_is_no_line() {
        let device = device().unwrap();
        let training = estimator().training;
        let times: Vec<f64> = (0..9).map(|at| f64::from(at) / 4.0 - 1.0).collect();
        let line = Sequence { values: times.iter().map(|s| 1.0 - 3.0 * s).collect(), times: times.clone() };
        let reading = training.read(&reader(0.75), &line, &device).unwrap();
        assert!(reading.exact && (reading.rate - 3.0).abs() < 1e-12, "{reading:?}");
        let flat = Sequence { values: vec![4.0; 9], times };
        let reading = training.read(&reader(0.7), &flat, &device).unwrap();
        assert!((reading.level, reading.rate) == (4.0, 0.0) && reading.is_settled(), "{reading:?}");
    }

    #[test]
    fn looks_are_counted_and_end() {
        let device = device().unwrap();
        let read = |share| estimator().training.read(&reader(share), &sequence(5.0), &device).unwrap();
        // It returns five times the rate that it sees, so the residual has a larger rate of the opposite sign
        // at every look.
        let reading = read(5.0);
        assert!(!reading.is_settled() && reading.looks == 20, "{reading:?}");
        // With twice the rate, full steps oscillate forever; half steps settle at the same answer as the
        // others.
        let (reading, other) = (read(2.0), read(0.7));
        assert!(reading.is_settled() && reading.looks > 10, "{reading:?}");
        assert!((reading.rate - other.rate).abs() < 0.05 * other.rate_std_error, "{reading:?} {other:?}");
    }

    #[test]
    fn sequences_read_together_are_read_as_alone() {
        let device = device().unwrap();
        let training = estimator().training;
        let sequences = [sequence(1.0), sequence(2.0)];
        let together = training.read_all(&reader(0.7), &sequences, &device).unwrap();
        for (one, peaks) in together.iter().zip(&sequences) {
            let alone = training.read(&reader(0.7), peaks, &device).unwrap();
            assert!((one.rate - alone.rate).abs() < 0.02 * alone.rate_std_error, "{one:?} {alone:?}");
        }
    }
}
