//! Choice of the clock of a record: the stamps, or the sample index.
//!
//! A logger's stamps are the times at which the host received the samples, not those at which the sensor took
//! them. A sensor with its own oscillator samples evenly; a regression of the stamps on the sample index then
//! gives the rate far better than any two stamps. If samples were lost, or the sensor is polled at irregular
//! times, the index carries no time information and only the stamps remain.
//!
//! The values decide between two clocks. The autocorrelation of the stamps' steps was tried and does not: for a
//! reading loop that sleeps until its next deadline it is neither −0.5 (late stamps of an even clock) nor 0.

#![allow(clippy::indexing_slicing, reason = "`Record::new` refuses a record without samples")]

use crate::error::Fault;
use crate::line::Line;
use crate::lost::Numbers;
use crate::record::{InputRow, Record, beside};
use crate::stamps::{SIGNIFICANT, StampStatistics, stamp_rounding, statistics, without_ties};
use crate::words::{counted, two_digits};
use serde::{Deserialize, Serialize};

/// Clock requested by a configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClockChoice {
    /// Stamps as written.
    Host,
    /// Even in the sample index, with the rate from a regression; rows without a value are counted.
    UniformIndex,
    /// The clock that the stamps and the values support.
    #[default]
    Auto,
}

impl ClockChoice {
    /// Names of all choices in configurations.
    pub const NAMES: &'static [&'static str] = &["host", "uniform-index", "auto"];
}

/// Clock in force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClockKind {
    /// Stamps as written.
    Host,
    /// Even in the sample index.
    UniformIndex,
    /// Even in the sample index after lost samples are counted.
    IndexWithGaps,
}

impl ClockKind {
    /// Returns the name used in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Host => "host",
            Self::UniformIndex => "uniform-index",
            Self::IndexWithGaps => "index-with-gaps",
        }
    }
}

/// Clock of a record: a time for every sample and the reason for these times.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    /// Kind of the clock.
    pub kind: ClockKind,
    /// Reason for the choice of the clock, as a sentence.
    pub reason: String,
    /// Time of every sample, in seconds, with the same origin as the stamps.
    pub times_s: Vec<f64>,
    /// Sampling rate by regression of the stamps on the sample index, in hertz. Lost samples are counted if
    /// the stamps show their number. Given for every kind of clock.
    pub sample_rate_hz: f64,
    /// Standard error of the sampling rate, widened for the autocorrelation of the stamps' deviations, in
    /// hertz.
    pub sample_rate_std_error_hz: f64,
    /// Statistics of the stamps on which the decision is based.
    pub statistics: StampStatistics,
}

impl Clock {
    /// Determines the clock of a record. Linear in the number of samples.
    ///
    /// The regression uses only the last sample of each group of equal stamps: it waited least for the host,
    /// so its stamp is the least late. Samples are numbered by their rows, so rows without a value are
    /// counted. If no more than a tenth of the stamps repeat, they are ties of stamps that scatter, and are moved
    /// apart by less than their rounding.
    ///
    /// `Auto` decides in this order:
    /// 1. Repeated stamps: two samples cannot be taken at once, so the stamps are receive times. The clock is
    ///    even in the index, with lost samples counted where groups come later than their samples explain.
    /// 2. Gaps: samples are missing, so the index is no clock. The host clock is used, unless the values run
    ///    more smoothly (as in 5) on the index with the lost samples counted, or with none lost where more than
    ///    one step in twenty is long, as in stamps that scatter by an interval. Among steps of rounded or
    ///    jittered stamps a lost sample need not make a long step, and only counting finds it; the rules
    ///    below therefore count lost samples in an even index too.
    /// 3. An even clock reproduces every stamp to a millionth of an interval, or to the step to which the
    ///    stamps are rounded: even in the index.
    /// 4. An even clock plus a parabola does so: the rates of the logger's and the sensor's clock drift
    ///    against each other, and a sensor samples by its own clock; even in the index.
    /// 5. The values: on the clock by which they were taken, five neighbors lie closer to a cubic. If one
    ///    clock is better by more than 2.33 standard errors (1 % by chance), it is used.
    /// 6. Otherwise the host clock: the stamps are used as written unless there is evidence against them.
    ///
    /// # Errors
    /// [`Fault::NoTimePasses`] if all stamps are equal.
    pub fn new(record: &Record, choice: ClockChoice) -> Result<Self, Fault> {
        let rounding = stamp_rounding(record.stamps_s());
        let stamps = &*without_ties(record.stamps_s(), rounding);
        let rows = record.row_numbers();
        let ends = group_ends(stamps, &rows);
        if ends.len() < 2 {
            return Err(Fault::NoTimePasses { stamp: stamps[0] });
        }
        let numbers = Numbers::with_lost(&ends, &rows, record.values(), rounding.unwrap_or(0.0))
            .unwrap_or_else(|| Numbers::plain(&ends, &rows));
        let line = Line::through(&numbers.ends);
        let statistics = statistics(stamps, record.values(), &ends, &numbers, &line, rounding);
        let rate = 1.0 / line.slope;
        let (kind, reason) = match choice {
            ClockChoice::Host => (ClockKind::Host, "set in the configuration".to_owned()),
            ClockChoice::UniformIndex => (ClockKind::UniformIndex, "set in the configuration".to_owned()),
            ClockChoice::Auto => decide(stamps, &statistics, &line),
        };
        let reason = match record.empty_rows() {
            0 => reason,
            _ if kind == ClockKind::Host => reason,
            empty => format!("{reason}; {} without a value counted in", counted(empty, "row")),
        };
        let plain = || Line::through(&ends);
        let times_s = match kind {
            ClockKind::Host => stamps.to_vec(),
            ClockKind::UniformIndex => {
                let line = plain();
                rows.iter().map(|row| line.intercept + line.slope * row).collect()
            }
            ClockKind::IndexWithGaps => {
                numbers.of_samples.iter().map(|number| line.intercept + line.slope * number).collect()
            }
        };
        Ok(Self {
            kind,
            reason,
            times_s,
            sample_rate_hz: rate,
            sample_rate_std_error_hz: line.slope_std_error() * rate * rate,
            statistics,
        })
    }

    /// Returns the time in seconds and the input of each of the record's [`Record::input_rows`]. The time is
    /// the row's stamp if the clock is the host's, and is otherwise interpolated between the neighboring samples, by row
    /// number, or by stamp for an input without a row number of its own.
    #[must_use]
    pub fn inputs_between(&self, record: &Record) -> Vec<(f64, f64)> {
        debug_assert_eq!(self.times_s.len(), record.len(), "a clock has a time for every sample");
        let rows = record.rows().unwrap_or(&[]);
        let by_number = |own: &InputRow| {
            let [(first, from), (last, to)] = beside(rows, &self.times_s, own.row)?;
            let passed = if own.row > first {
                (own.row - first) as f64 / (last - first) as f64
            } else {
                let [(_, before), (_, after)] = beside(rows, record.stamps_s(), own.row)?;
                (own.stamp_s - before) / (after - before)
            };
            Some(from + (to - from) * passed).filter(|time| time.is_finite())
        };
        let time = |own: &InputRow| match self.kind {
            ClockKind::Host => own.stamp_s,
            // Always found: the record has checked that the row lies between two samples.
            _ => by_number(own).unwrap_or(own.stamp_s),
        };
        record.input_rows().iter().map(|own| (time(own), own.input)).collect()
    }

    /// Returns the time from the first sample to the last one, in seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        match self.times_s.as_slice() {
            [first, .., last] => last - first,
            _ => 0.0,
        }
    }

    /// Returns the time of the first sample, in seconds.
    #[must_use]
    pub fn start_s(&self) -> f64 {
        self.times_s[0]
    }
}

fn decide(stamps: &[f64], found: &StampStatistics, line: &Line) -> (ClockKind, String) {
    let rate = 1.0 / line.slope;
    let preference = found.preference_for_even;
    // The even clock was tested with lost samples counted, so it includes them.
    let even = |reason: String| match found.lost {
        0 => (ClockKind::UniformIndex, reason),
        lost => (ClockKind::IndexWithGaps, format!("{reason}; {} lost", counted(lost, "sample"))),
    };
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
        return even(reason);
    }
    if found.gaps > 0 && found.lost > 0 && preference > SIGNIFICANT {
        let reason = format!(
            "{} missing in {}; counted in, the values run more smoothly on an even clock of {rate:.2} Hz than on the \
             stamps ({preference:.1} standard errors)",
            counted(found.lost, "sample"),
            counted(found.gaps, "gap"),
        );
        return (ClockKind::IndexWithGaps, reason);
    }
    if found.gaps > 0 {
        let reason = format!(
            "{} of more than 1.5 times the median step: samples are missing, so the index is not a clock",
            counted(found.gaps, "gap"),
        );
        return (ClockKind::Host, reason);
    }
    if found.largest_deviation_s <= EVEN * line.slope {
        let reason = format!("the stamps are even: {rate:.4} Hz, to a millionth of a sampling interval");
        return even(reason);
    }
    if let Some(rounding) = found.rounding_s.filter(|step| found.largest_deviation_s <= *step) {
        let reason = format!(
            "an even clock of {rate:.4} Hz reproduces every stamp to within the {} ms the stamps \
             are rounded to",
            two_digits(1e3 * rounding)
        );
        return even(reason);
    }
    if let Some(rounding) = found.rounding_s.filter(|step| found.left_by_bend_s <= *step) {
        let reason = format!(
            "the stamps bend away from an even clock of {rate:.4} Hz by {} ms and lie within the {} ms that they \
             are rounded to of a parabola: the logger's clock drifts against the sensor's",
            two_digits(1e3 * found.bend_s),
            two_digits(1e3 * rounding)
        );
        return even(reason);
    }
    if preference > SIGNIFICANT {
        let reason = format!(
            "the values run more smoothly on an even clock of {rate:.2} Hz than on the stamps ({preference:.1} \
             standard errors), so the stamps' jitter of {} ms is the host's",
            two_digits(1e3 * found.deviation_s)
        );
        return even(reason);
    }
    let reason = if preference < -SIGNIFICANT {
        format!(
            "the values run more smoothly on the stamps than on an even clock ({:.1} standard errors): the \
             sensor was read at the stamped times",
            -preference
        )
    } else {
        "the stamps are distinct, and the values do not distinguish them from an even clock".to_owned()
    };
    (ClockKind::Host, reason)
}

/// Largest distance from an even clock, in sampling intervals, at which stamps count as even, whatever the
/// values show.
const EVEN: f64 = 1e-6;

/// Returns the row number and the stamp of the last sample of each group of equal stamps. The record's last
/// group may be cut off, so that its last sample need not be the least late; with many groups this does not
/// matter.
fn group_ends(stamps: &[f64], rows: &[f64]) -> Vec<(f64, f64)> {
    let following = stamps.iter().skip(1).map(Some).chain([None]);
    stamps
        .iter()
        .zip(following)
        .zip(rows)
        .filter(|((stamp, next), _)| *next != Some(*stamp))
        .map(|((&stamp, _), &row)| (row, stamp))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{Clock, ClockChoice, ClockKind};
    use crate::record::{Quantity, Record};

    /// Returns the clock of a motion that was sampled at the given true times.
    fn auto_of(stamps: Vec<f64>, times: &[f64]) -> Clock {
        let values = times.iter().map(|t| (20.0 * t).sin()).collect();
        let record = Record::new(stamps, values, None, Quantity::Position, "rad").unwrap();
        Clock::new(&record, ClockChoice::Auto).unwrap()
    }

    fn auto(stamps: Vec<f64>) -> Clock {
        let times = stamps.clone();
        auto_of(stamps, &times)
    }

    /// Returns pseudo-random numbers in −0.5..0.5 without a generator.
    fn noise(index: usize) -> f64 {
        (index as f64 * 12.9898).sin().mul_add(43_758.545_3, 0.0).rem_euclid(1.0) - 0.5
    }

    /// Stamps that scatter by an interval, in the order of their times.
    #[test]
    fn stamps_that_scatter_by_an_interval_have_no_gaps() {
        let times: Vec<f64> = (0..3000).map(|index| index as f64 / 100.0).collect();
        let mut stamps: Vec<f64> =
            times.iter().enumerate().map(|(index, time)| time + 3e-2 * noise(index)).collect();
        stamps.sort_by(f64::total_cmp);
        let values =
            times.iter().enumerate().map(|(at, t)| (6.0 * t).sin() + 2e-3 * noise(7 * at + 1)).collect();
        let record = Record::new(stamps, values, None, Quantity::Position, "rad").unwrap();
        let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
        assert_eq!(clock.kind, ClockKind::UniformIndex, "{} {:?}", clock.reason, clock.statistics);
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

    /// A lost sample at 625 Hz makes a step of 3.2 ms, which is not a long one among steps of 1 and 2 ms;
    /// counting finds it.
    #[test]
    fn a_loss_that_rounded_stamps_hide_from_the_steps_is_in_the_times() {
        let numbers: Vec<usize> = (0..3000).filter(|i| *i != 1234).collect();
        let stamps: Vec<f64> = numbers.iter().map(|i| (*i as f64 * 1.6).round() / 1e3).collect();
        let times: Vec<f64> = numbers.iter().map(|i| *i as f64 * 1.6e-3).collect();
        let clock = auto_of(stamps, &times);
        assert_eq!((clock.statistics.gaps, clock.statistics.lost), (0, 1), "{}", clock.reason);
        assert_eq!(clock.kind, ClockKind::IndexWithGaps, "{}", clock.reason);
        assert!(clock.reason.contains("reproduces every stamp"), "{}", clock.reason);
        assert!(clock.reason.contains("1 sample lost"), "{}", clock.reason);
        let wrong = clock.times_s.iter().zip(&times).map(|(found, time)| (found - time).abs());
        assert!(wrong.fold(0.0, f64::max) < 0.2e-3, "a loss of 1.6 ms is in none of the times");
    }

    /// Losses with a drifting logger clock are counted in the even clock from which the parabola is fitted.
    #[test]
    fn such_a_loss_is_in_the_times_of_a_clock_that_drifts() {
        let numbers: Vec<usize> = (0..12_000).filter(|i| i % 1700 != 850).collect();
        let times: Vec<f64> = numbers.iter().map(|i| *i as f64 * 1.6e-3).collect();
        let stamps = times.iter().map(|time| ((time + 1.2e-5 * time * time) * 1e3).round() / 1e3).collect();
        let clock = auto_of(stamps, &times);
        assert_eq!((clock.statistics.gaps, clock.statistics.lost), (0, 7), "{}", clock.reason);
        assert_eq!(clock.kind, ClockKind::IndexWithGaps, "{}", clock.reason);
        assert!(clock.reason.contains("parabola"), "{}", clock.reason);
        assert!(clock.reason.contains("7 samples lost"), "{}", clock.reason);
    }

    /// Losses among steps that jitter alone makes long are no gaps; counting finds them too.
    #[test]
    fn a_loss_among_steps_that_jitter_made_long_is_in_the_times() {
        let numbers: Vec<usize> = (0..3000).filter(|i| i % 900 != 450).collect();
        let times: Vec<f64> = numbers.iter().map(|i| *i as f64 * 0.01).collect();
        // A sum of four uniform numbers has larger outliers than one uniform number of the same variance.
        let jitter = |i: usize| (0..4).map(|part| noise(4 * i + part)).sum::<f64>();
        let stamps = numbers.iter().map(|i| *i as f64 * 0.01 + 0.0024 * jitter(*i)).collect();
        let clock = auto_of(stamps, &times);
        assert_eq!((clock.statistics.gaps, clock.statistics.lost), (0, 3), "{}", clock.reason);
        assert_eq!(clock.kind, ClockKind::IndexWithGaps, "{}", clock.reason);
        assert!(clock.reason.contains("more smoothly"), "{}", clock.reason);
        assert!(clock.reason.contains("3 samples lost"), "{}", clock.reason);
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
        assert!(clock.reason.contains("at the stamped times"), "{}", clock.reason);
    }

    /// Regression: a stated rate gives stamps that doubles cannot hold exactly; the values must not affect
    /// the decision.
    #[test]
    fn stamps_from_a_stated_rate_are_even() {
        let clock = auto((0..2000).map(|i| i as f64 / 610.35).collect());
        assert_eq!(clock.kind, ClockKind::UniformIndex, "{}", clock.reason);
        assert!(clock.reason.contains("610.3500 Hz"), "{}", clock.reason);
    }

    #[test]
    fn values_at_rest_cannot_tell() {
        let stamps = jittered();
        let clock = auto_of(stamps, &[0.3; 2000]);
        assert_eq!(clock.kind, ClockKind::Host, "{}", clock.reason);
        assert!(clock.reason.contains("do not distinguish"), "{}", clock.reason);
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
