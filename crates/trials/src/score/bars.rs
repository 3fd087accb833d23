//! Bars: values that scores have to reach, and the measured values.

use super::accuracy::{kind_right, range, within};
use super::judgment::Judgment;
use super::regret::missed;
use super::statistics::{NO_NUMBER, proportion};
use crate::effects::{SEPARABLE_OTHERWISE, find};
use crate::hidden::{Asked, Bank};
use results::{BarRow, ClosureStudy, Proportion, Quantiles, Reliability, UnknownStudy, WithInterval};

/// Returns the size at which an effect is separable with a number of records.
fn separable(effect: &str, records: usize) -> f64 {
    let [one, two, three] = find(effect).map_or(SEPARABLE_OTHERWISE, |effect| effect.separable);
    match records {
        0 | 1 => one,
        2 => two,
        _ => three,
    }
}

/// Results of the other tables that bars need.
pub(crate) struct Measured<'a> {
    pub(crate) judged: &'a [Judgment<'a>],
    pub(crate) reliability: &'a [Reliability],
    pub(crate) unknown: &'a UnknownStudy,
    pub(crate) ratio_to_floor: &'a Quantiles,
    pub(crate) closure: &'a ClosureStudy,
    pub(crate) seconds: &'a Quantiles,
}

/// Side of a value on which a measure should lie.
pub(crate) enum Side {
    AtLeast(f64),
    AtMost(f64),
    Within(f64, f64),
}

pub(crate) fn row(metric: &str, unit: &str, side: Side, found: WithInterval, cases: u64) -> BarRow {
    let (at_least, at_most) = match side {
        Side::AtLeast(bar) => (Some(bar), None),
        Side::AtMost(bar) => (None, Some(bar)),
        Side::Within(low, high) => (Some(low), Some(high)),
    };
    let [low, high] = found.interval_95;
    let is_low = |value: f64| at_least.is_some_and(|bar| value < bar);
    let is_high = |value: f64| at_most.is_some_and(|bar| value > bar);
    let measured = cases > 0 && found.value.is_finite();
    let state = match measured {
        false => "not measured here",
        true if is_low(found.value) || is_high(found.value) => "not met",
        true => "met",
    };
    BarRow {
        metric: metric.to_owned(),
        at_least,
        at_most,
        unit: unit.to_owned(),
        value: found.value,
        interval_95: found.interval_95,
        cases,
        state: state.to_owned(),
        missed_beyond_chance: measured && (is_low(high) || is_high(low)),
    }
}

pub(crate) fn share(metric: &str, side: Side, found: &Proportion) -> BarRow {
    let found_with = WithInterval { value: found.share, interval_95: found.interval_95 };
    row(metric, "%", side, found_with, found.of)
}

/// Returns the bars in the order of their document.
pub(crate) fn bars(measured: &Measured<'_>) -> Vec<BarRow> {
    use Side::{AtLeast, AtMost, Within};
    let judged = measured.judged;
    let about = |size: usize| range(size);
    let at = |bank: Bank, size: [f64; 2]| {
        judged.iter().filter(move |judgment| judgment.bank() == bank && within(judgment.size(), size))
    };
    // Indices into SIZES.
    let [twelve, twenty_five, hundred] = [2, 3, 5].map(about);
    let alarms = judged.iter().filter(|judgment| judgment.asked() == Asked::Nothing).map(Judgment::alarms);
    let far = judged
        .iter()
        .filter(|judgment| matches!(judgment.bank(), Bank::Single | Bank::Releases | Bank::Driven))
        .filter(|judgment| {
            let effects = judgment.case.hidden.effects.first();
            let records = judgment.answer().map_or(1, |answer| answer.records.len());
            effects.is_some_and(|effect| effect.detectability >= 2.0 * separable(&effect.id, records))
        });
    let class = |size| proportion(at(Bank::Single, size).map(|judgment| judgment.class));
    let both = |size| proportion(at(Bank::Pair, size).map(|judgment| judgment.both));
    let error = |metric: &str, banks: &str, bar: f64| {
        let found = measured.reliability.iter().find(|row| row.subject == "confidence" && row.banks == banks);
        let (error, count) = found.map_or((NO_NUMBER, 0), |row| (row.calibration_error, row.count));
        let mut row = row(metric, "", AtMost(bar), error, count);
        // A miss that scatter alone would cause does not count.
        let chance = found.map_or(f64::NAN, |row| row.calibration_error_by_chance);
        row.missed_beyond_chance = error.interval_95[0] - chance > bar;
        row
    };
    let area = measured.unknown.areas.iter().find(|row| row.size == Some(25.0));
    let of_area = area.map_or((NO_NUMBER, 0), |row| (row.area, row.positives));
    let ratio = measured.ratio_to_floor;
    let seconds = measured.seconds;
    vec![
        share("false alarms where nothing is missing", AtMost(0.012), &proportion(alarms)),
        share(
            "first name, at twice the size that separates it",
            AtLeast(0.95),
            &proportion(far.map(|judgment| judgment.top_1)),
        ),
        share("class of the first name, size 12", AtLeast(0.93), &class(twelve)),
        share("class of the first name, size 25", AtLeast(0.97), &class(twenty_five)),
        share("both of a pair, size 25", AtLeast(0.80), &both(twenty_five)),
        share("both of a pair, size 100", AtLeast(0.93), &both(hundred)),
        share("kind of verdict, size 25", AtLeast(0.95), &kind_right(judged, twenty_five)),
        share("regret above 1.1", AtMost(0.05), &missed(judged.iter())),
        error("calibration error of confidence, own banks", "own", 0.03),
        error("calibration error of confidence, stressed bank", "stressed", 0.05),
        row("area under the curve of unknown, size 25", "", AtLeast(0.95), of_area.0, of_area.1),
        row("held-out error over floor, median", "", AtMost(1.05), ratio.median, ratio.count),
        share("95 % intervals of closure that hold", Within(0.93, 0.97), &measured.closure.coverage),
        row("time of an answer, median", "s", AtMost(5.0), seconds.median, seconds.count),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_is_missed_beyond_chance_only_with_the_whole_interval() {
        let of = |value, interval_95, side| row("x", "", side, WithInterval { value, interval_95 }, 9);
        let near = of(0.94, [0.90, 0.97], Side::AtLeast(0.95));
        assert!(near.state == "not met" && !near.missed_beyond_chance);
        let far = of(0.80, [0.75, 0.85], Side::AtLeast(0.95));
        assert!(far.state == "not met" && far.missed_beyond_chance);
        assert_eq!(of(0.96, [0.90, 0.99], Side::AtLeast(0.95)).state, "met");
        assert!(of(0.99, [0.98, 1.0], Side::Within(0.93, 0.97)).missed_beyond_chance);
        assert!(of(0.02, [0.013, 0.03], Side::AtMost(0.012)).missed_beyond_chance);
        let none = row("x", "", Side::AtMost(1.0), NO_NUMBER, 0);
        assert!(none.state == "not measured here" && !none.missed_beyond_chance);
    }

    #[test]
    fn sizes_that_separate_go_by_effect_and_number_of_records() {
        assert_eq!((separable("gravity", 2), separable("end_stop", 1)), (301.0, 6.0));
        assert_eq!(separable("gravity", 9), 122.0);
    }
}
