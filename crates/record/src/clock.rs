//! Which clock to believe.
//!
//! A logger's stamps say when the host received a sample, not when the sensor took it. A sensor that
//! samples by its own oscillator takes its samples evenly; the regression of the stamps on the sample
//! index then gives the rate far better than any two stamps. Where samples were lost, or the sensor is
//! polled at odd times, the index knows nothing and the stamps are all there is.

use crate::error::Fault;
use crate::line::Line;
use crate::record::Record;
use serde::{Deserialize, Serialize};

/// What a configuration asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClockChoice {
    /// The stamps as written.
    Host,
    /// Even in the sample index, rate by regression.
    UniformIndex,
    /// Whichever the stamps themselves speak for.
    #[default]
    Auto,
}

impl ClockChoice {
    /// Every choice's name as configurations write it.
    pub const NAMES: &'static [&'static str] = &["host", "uniform-index", "auto"];
}

/// The clock in force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClockKind {
    /// The stamps as written.
    Host,
    /// Even in the sample index.
    UniformIndex,
}

impl ClockKind {
    /// The name as results write it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Host => "host",
            Self::UniformIndex => "uniform-index",
        }
    }
}

/// What the stamps look like.
#[derive(Debug, Clone, PartialEq)]
pub struct StampStatistics {
    /// Stamps equal to the one before.
    pub repeated: usize,
    /// Groups of equal stamps, single ones included.
    pub groups: usize,
    /// Most samples that share one stamp.
    pub largest_group: usize,
    /// Median time between groups, in seconds.
    pub group_interval_s: f64,
    /// Where no stamp is repeated: steps longer than 1.5 times the median step by more than the stamps
    /// are rounded to. Samples are missing there. None where it is jitter that makes steps long: their neighbors
    /// are then as much too short.
    pub gaps: usize,
    /// The decimal step that stamps are rounded to, in seconds, where there is one.
    pub rounding_s: Option<f64>,
    /// Root mean square distance of the groups' last stamps from an even clock, in seconds.
    pub deviation_s: f64,
    /// Largest such distance, in seconds.
    pub largest_deviation_s: f64,
}

/// A clock for a record: a time for every sample, and why these times.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    /// Which clock it is.
    pub kind: ClockKind,
    /// Why it is in force: a sentence.
    pub reason: String,
    /// Time of every sample, in seconds, on the stamps' own origin.
    pub times_s: Vec<f64>,
    /// Sampling rate by regression of stamps on the sample index, in hertz; stated for every clock.
    pub sample_rate_hz: f64,
    /// Its standard error, widened for the autocorrelation of the stamps' deviations, in hertz.
    pub sample_rate_std_error_hz: f64,
    /// What the decision rests on.
    pub statistics: StampStatistics,
}

impl Clock {
    /// Lays a clock over a record's stamps. Linear in the number of samples.
    ///
    /// The regression uses the last sample of each group of equal stamps only: it waited least for the
    /// host, so its stamp is the least late.
    ///
    /// `Auto` decides in this order:
    /// 1. repeated stamps: two samples cannot be taken at once, so the stamps are receive times; even
    ///    in the index;
    /// 2. gaps: samples are missing, the index is no clock; host;
    /// 3. an even clock reproduces every stamp to the step the stamps are rounded to: even in the index;
    /// 4. the values themselves: on the clock they were taken by, five neighbors lie closer to a cubic.
    ///    Where one clock is better by more than 2.33 standard errors (1 % of chance), that one;
    /// 5. otherwise host: what is written stands until something speaks against it.
    ///
    /// # Errors
    /// [`Fault::NoTimePasses`] where all stamps are equal.
    pub fn new(record: &Record, choice: ClockChoice) -> Result<Self, Fault> {
        let stamps = record.stamps_s();
        let first = stamps.first().copied().unwrap_or_default();
        let ends = group_ends(stamps);
        if ends.len() < 2 {
            return Err(Fault::NoTimePasses { stamp: first });
        }
        let line = Line::through(&ends);
        let statistics = statistics(stamps, &ends, &line);
        let rate = 1.0 / line.slope;
        let (kind, reason) = match choice {
            ClockChoice::Host => (ClockKind::Host, "set in the configuration".to_owned()),
            ClockChoice::UniformIndex => (ClockKind::UniformIndex, "set in the configuration".to_owned()),
            ClockChoice::Auto => decide(stamps, record.values(), &statistics, &line),
        };
        let times_s = match kind {
            ClockKind::Host => stamps.to_vec(),
            ClockKind::UniformIndex => {
                (0..stamps.len()).map(|i| line.intercept + line.slope * i as f64).collect()
            }
        };
        Ok(Self {
            kind,
            reason,
            times_s,
            sample_rate_hz: rate,
            sample_rate_std_error_hz: slope_std_error(&line) * rate * rate,
            statistics,
        })
    }
}

fn decide(stamps: &[f64], values: &[f64], found: &StampStatistics, line: &Line) -> (ClockKind, String) {
    let rate = 1.0 / line.slope;
    if found.repeated > 0 {
        let share = 100.0 * found.repeated as f64 / stamps.len() as f64;
        let reason = format!(
            "{} of {} stamps ({share:.0} %) repeat the one before: samples arrive in {} groups about \
             {:.0} ms apart, so the stamps are receive times; even in the index, the sensor runs at \
             {rate:.2} Hz",
            found.repeated,
            stamps.len(),
            found.groups,
            1e3 * found.group_interval_s,
        );
        return (ClockKind::UniformIndex, reason);
    }
    if found.gaps > 0 {
        let reason = format!(
            "{} steps are longer than 1.5 times the median step: samples are missing, so the index \
             is no clock",
            found.gaps
        );
        return (ClockKind::Host, reason);
    }
    if let Some(rounding) = found.rounding_s.filter(|step| found.largest_deviation_s <= *step) {
        let reason = format!(
            "an even clock of {rate:.4} Hz reproduces every stamp to within the {:.3} ms the stamps \
             are rounded to",
            1e3 * rounding
        );
        return (ClockKind::UniformIndex, reason);
    }
    let preference = preference_for_even(stamps, values, line);
    if preference > SIGNIFICANT {
        let reason = format!(
            "the values run more smoothly on an even clock of {rate:.2} Hz than on the stamps ({preference:.1} \
             standard errors), so the stamps' jitter of {:.3} ms is the host's",
            1e3 * found.deviation_s
        );
        return (ClockKind::UniformIndex, reason);
    }
    let reason = if preference < -SIGNIFICANT {
        format!(
            "the values run more smoothly on the stamps than on an even clock ({:.1} standard errors): \
             the sensor was read when they say",
            -preference
        )
    } else {
        "the stamps are distinct, and the values do not tell them from an even clock".to_owned()
    };
    (ClockKind::Host, reason)
}

/// Standard errors that a preference must have: 1 % of chance, one-sided.
const SIGNIFICANT: f64 = 2.33;

/// By how many standard errors the values run more smoothly on the even clock than on the stamps.
///
/// Five neighbors deviate from a cubic by one number, their fourth divided difference scaled to unit
/// noise. On a clock that is wrong by δ it grows by δ times the speed. The squares under either clock are
/// compared in pairs, over stretches that do not overlap. Stamps must increase.
fn preference_for_even(stamps: &[f64], values: &[f64], line: &Line) -> f64 {
    let even: Vec<f64> = (0..stamps.len()).map(|i| line.slope * i as f64).collect();
    let squares = |times: &[f64]| -> Vec<f64> {
        times.chunks_exact(5).zip(values.chunks_exact(5)).map(|(t, y)| off_cubic(t, y).powi(2)).collect()
    };
    let differences: Vec<f64> =
        squares(stamps).iter().zip(squares(&even)).map(|(host, even)| host - even).collect();
    let count = differences.len() as f64;
    let mean = differences.iter().sum::<f64>() / count;
    let variance = differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let z = mean / (variance / count).sqrt();
    if z.is_finite() { z } else { 0.0 }
}

/// Distance of points from a cubic, in the noise of a point: Σ cᵢ·yᵢ with cᵢ = 1/Π (tᵢ − tⱼ), scaled to
/// Σ cᵢ² = 1.
fn off_cubic(times: &[f64], values: &[f64]) -> f64 {
    // Relative to the first value, so that values at rest lie on the cubic exactly.
    let origin = values.first().copied().unwrap_or_default();
    let (mut sum, mut norm) = (0.0, 0.0);
    for (at, (&time, &value)) in times.iter().zip(values).enumerate() {
        let product: f64 = times
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != at)
            .map(|(_, other)| time - other)
            .product();
        sum += (value - origin) / product;
        norm += 1.0 / (product * product);
    }
    sum / norm.sqrt()
}

/// Index and stamp of the last sample of each group of equal stamps. The record's last group may be
/// cut off, so its last sample need not have been the least late; with many groups it does not matter.
fn group_ends(stamps: &[f64]) -> Vec<(f64, f64)> {
    let following = stamps.iter().skip(1).map(Some).chain([None]);
    stamps
        .iter()
        .zip(following)
        .enumerate()
        .filter(|(_, (stamp, next))| *next != Some(*stamp))
        .map(|(index, (&stamp, _))| (index as f64, stamp))
        .collect()
}

/// The decimal step that stamps are rounded to.
fn stamp_rounding(stamps: &[f64]) -> Option<f64> {
    // Decimal rounding is what loggers do; a handful of powers of ten is all there is to try.
    let span = stamps.last()? - stamps.first()?;
    (1..=9)
        .map(|digits| 10_f64.powi(digits))
        .find(|scale| {
            let tolerance = 1e-3_f64.max(scale * 4.0 * f64::EPSILON * (span + 1e4));
            tolerance < 0.1
                && stamps.iter().all(|stamp| {
                    let scaled = stamp * scale;
                    (scaled - scaled.round()).abs() <= tolerance
                })
        })
        .map(|scale| 1.0 / scale)
}

fn statistics(stamps: &[f64], ends: &[(f64, f64)], line: &Line) -> StampStatistics {
    let steps: Vec<f64> = ends.iter().zip(ends.iter().skip(1)).map(|(one, next)| next.1 - one.1).collect();
    let mut ordered = steps.clone();
    ordered.sort_by(f64::total_cmp);
    let median = ordered.get(ordered.len() / 2).copied().unwrap_or_default();
    let largest_group = ends
        .iter()
        .scan(-1.0, |previous, end| {
            let size = end.0 - *previous;
            *previous = end.0;
            Some(size)
        })
        .fold(0.0, f64::max);
    let repeated = stamps.len() - ends.len();
    let rounding_s = stamp_rounding(stamps);
    let long = 1.5 * median + rounding_s.unwrap_or_default().min(0.5 * median);
    StampStatistics {
        repeated,
        groups: ends.len(),
        largest_group: largest_group as usize,
        group_interval_s: median,
        gaps: if repeated == 0 { gaps(&steps, median, long) } else { 0 },
        rounding_s,
        deviation_s: (line.squares() / ends.len() as f64).sqrt(),
        largest_deviation_s: line.residuals.iter().fold(0.0, |most, r| f64::max(most, r.abs())),
    }
}

/// Steps longer than `long`, unless it is jitter that makes them so.
///
/// A stamp that is late by e makes its step longer by e and the next one shorter by as much: over all long steps the
/// neighbors are short by as much as these are long. A missing sample leaves its neighbors as they are.
fn gaps(steps: &[f64], median: f64, long: f64) -> usize {
    let (mut count, mut excess, mut made_up) = (0, 0.0, 0.0);
    for (index, step) in steps.iter().enumerate().filter(|(_, step)| **step > long) {
        count += 1;
        excess += step - median;
        let before = index.checked_sub(1).and_then(|before| steps.get(before));
        made_up += before.into_iter().chain(steps.get(index + 1)).map(|other| median - other).sum::<f64>();
    }
    if made_up > 0.5 * excess { 0 } else { count }
}

/// Lag-one autocorrelation about the mean; 0 for a constant series.
fn autocorrelation(series: &[f64]) -> f64 {
    let mean = series.iter().sum::<f64>() / series.len().max(1) as f64;
    let square: f64 = series.iter().map(|x| (x - mean).powi(2)).sum();
    let product: f64 = series.iter().zip(series.iter().skip(1)).map(|(a, b)| (a - mean) * (b - mean)).sum();
    if square > 0.0 { product / square } else { 0.0 }
}

/// Standard error of a line's slope under AR(1) residuals, which carry (1 − r)/(1 + r) as much
/// information as white ones.
fn slope_std_error(line: &Line) -> f64 {
    let r = autocorrelation(&line.residuals).clamp(0.0, 0.99);
    let degrees = (line.residuals.len() as f64 - 2.0).max(1.0);
    (line.squares() / degrees * (1.0 + r) / (1.0 - r) / line.spread_x).sqrt()
}

#[cfg(test)]
mod tests {
    use super::{Clock, ClockChoice, ClockKind};
    use crate::record::{Quantity, Record};

    /// The clock of a motion that was seen at the given true times.
    fn auto_of(stamps: Vec<f64>, times: &[f64]) -> Clock {
        let values = times.iter().map(|t| (20.0 * t).sin()).collect();
        let record = Record::new(stamps, values, None, Quantity::Position, "rad").unwrap();
        Clock::new(&record, ClockChoice::Auto).unwrap()
    }

    fn auto(stamps: Vec<f64>) -> Clock {
        let times = stamps.clone();
        auto_of(stamps, &times)
    }

    /// Pseudo-random numbers in −0.5..0.5 without a generator.
    fn noise(index: usize) -> f64 {
        (index as f64 * 12.9898).sin().mul_add(43_758.545_3, 0.0).rem_euclid(1.0) - 0.5
    }

    #[test]
    fn bursts_are_receive_times() {
        let stamps: Vec<f64> = (0..3000).map(|i| ((i / 16) as f64 * 0.0616 * 1e3).round() / 1e3).collect();
        let clock = auto(stamps);
        assert_eq!(clock.kind, ClockKind::UniformIndex, "{}", clock.reason);
        let rate = 16.0 / 0.0616;
        assert!((clock.sample_rate_hz - rate).abs() < 4.0 * clock.sample_rate_std_error_hz + 1e-3);
        assert!(clock.reason.contains("receive times"), "{}", clock.reason);
    }

    #[test]
    fn rounded_even_stamps_are_even() {
        let stamps: Vec<f64> = (0..3000).map(|i| (i as f64 * 10.039).round() / 1e3).collect();
        let clock = auto(stamps);
        assert_eq!(clock.kind, ClockKind::UniformIndex, "{}", clock.reason);
        assert!((clock.sample_rate_hz - 1e3 / 10.039).abs() < 1e-3);
    }

    fn jittered() -> Vec<f64> {
        (0..2000).map(|i| i as f64 * 0.01 + 0.001 * noise(i)).collect()
    }

    #[test]
    fn jitter_that_the_values_do_not_share_is_the_hosts() {
        let even: Vec<f64> = (0..2000).map(|i| i as f64 * 0.01).collect();
        let clock = auto_of(jittered(), &even);
        assert_eq!(clock.kind, ClockKind::UniformIndex, "{}", clock.reason);
        assert!(clock.reason.contains("jitter"), "{}", clock.reason);
    }

    #[test]
    fn jitter_that_the_values_share_is_the_sensors() {
        let clock = auto(jittered());
        assert_eq!(clock.kind, ClockKind::Host, "{}", clock.reason);
        assert!(clock.reason.contains("when they say"), "{}", clock.reason);
    }

    #[test]
    fn values_at_rest_cannot_tell() {
        let stamps = jittered();
        let clock = auto_of(stamps, &[0.3; 2000]);
        assert_eq!(clock.kind, ClockKind::Host, "{}", clock.reason);
        assert!(clock.reason.contains("do not tell"), "{}", clock.reason);
    }

    #[test]
    fn strong_jitter_is_no_gap() {
        let even: Vec<f64> = (0..2000).map(|i| i as f64 * 0.01).collect();
        let stamps = (0..2000).map(|i| i as f64 * 0.01 + 0.009 * noise(i)).collect();
        let clock = auto_of(stamps, &even);
        assert_eq!(clock.statistics.gaps, 0);
        assert_eq!(clock.kind, ClockKind::UniformIndex, "{}", clock.reason);
    }

    #[test]
    fn gaps_are_seen_through_jitter() {
        let stamps = (0..2000).filter(|i| i % 97 != 3).map(|i| i as f64 * 0.01 + 0.001 * noise(i)).collect();
        let clock = auto(stamps);
        assert_eq!(clock.statistics.gaps, 21);
        assert_eq!(clock.kind, ClockKind::Host, "{}", clock.reason);
    }

    #[test]
    fn gaps_speak_for_the_host() {
        let clock = auto((0..2000).filter(|i| i % 97 != 3).map(|i| i as f64 * 0.01).collect());
        assert_eq!(clock.kind, ClockKind::Host, "{}", clock.reason);
        assert!(clock.reason.contains("missing"), "{}", clock.reason);
    }
}
