//! Plots of the record against the simulators, and of their residuals.

use results::{DiagnosisResult, RecordRow, SeriesRow};

use super::figures::{Simulator, framed, observed_axis, recorded};
use super::spectrum;
use crate::classes::listed;
use crate::figures::{Figure, csv, number};
use crate::format::{self, quantity, significant};
use crate::plot::{Axis, BREAK, Hue, Mark, Plot, Series};
use crate::{Reader, whole};

/// Largest number of samples shown of the worst stretch: a few periods of an ordinary record.
const MOST_SHOWN: usize = 500;
/// Largest number of records in one plot.
const MOST_RECORDS: usize = 4;

/// The stretch in which the recalibrated simulator has the largest error.
struct Worst<'a> {
    record: usize,
    rows: &'a [SeriesRow],
}

impl Worst<'_> {
    fn span(&self) -> (f64, f64) {
        let time = |row: Option<&SeriesRow>| row.map_or(0.0, |row| row.time_s);
        (time(self.rows.first()), time(self.rows.last()))
    }
}

/// Returns the plot that shows record and simulators together, for the top of the page, and the others.
pub(super) fn figures(
    result: &DiagnosisResult,
    rows: &[SeriesRow],
    reader: Reader,
) -> (Vec<Figure>, Vec<Figure>) {
    let Some(worst) = worst(rows) else { return (Vec::new(), Vec::new()) };
    let wholes = result.records.iter().take(MOST_RECORDS).enumerate().filter_map(|(index, record)| {
        let of = if result.records.len() > 1 { format!(" of record {}", index + 1) } else { String::new() };
        let title = format!("The part{of} that was read");
        whole::figure(format!("whole-{}", index + 1), title, observed_axis(result), &record.reading, reader)
    });
    let others = [
        overview(result, rows, &worst),
        input(result, rows),
        residuals(result, rows, &worst),
        spectrum::figure(result, rows),
    ];
    (zoom(result, &worst).into_iter().collect(), wholes.chain(others.into_iter().flatten()).collect())
}

fn worst(rows: &[SeriesRow]) -> Option<Worst<'_>> {
    let off = |row: &SeriesRow| (row.observed - row.recalibrated).powi(2);
    let segments = rows.chunk_by(|one, next| one.segment == next.segment);
    let mean = |rows: &[SeriesRow]| rows.iter().map(off).sum::<f64>() / rows.len().max(1) as f64;
    let segment = segments.max_by(|a, b| mean(a).total_cmp(&mean(b)))?;
    // For a long segment, the part around its largest deviation.
    let at = segment.iter().enumerate().max_by(|a, b| off(a.1).total_cmp(&off(b.1)))?.0;
    let start = at.saturating_sub(MOST_SHOWN / 2).min(segment.len().saturating_sub(MOST_SHOWN));
    let rows = segment.get(start..(start + MOST_SHOWN).min(segment.len()))?;
    Some(Worst { record: rows.first()?.record, rows })
}

fn time() -> Axis {
    Axis::linear("time (s)")
}

/// Returns one line for each of the first records; `single` is the label if there is only one.
fn by_record(
    result: &DiagnosisResult,
    rows: &[SeriesRow],
    single: &str,
    value: fn(&SeriesRow) -> f64,
) -> Vec<Series> {
    let records = rows.chunk_by(|one, next| one.record == next.record).take(MOST_RECORDS);
    let several = result.records.len() > 1;
    records
        .enumerate()
        .map(|(index, rows)| Series {
            label: if several {
                format!("record {}", rows.first().map_or(0, |row| row.record))
            } else {
                single.to_owned()
            },
            hue: if several { Hue::of_series(index) } else { Hue::Data },
            mark: Mark::Line,
            points: pieces(rows, value),
        })
        .collect()
}

/// Returns the plot of the input, if a record has one.
fn input(result: &DiagnosisResult, rows: &[SeriesRow]) -> Option<Figure> {
    rows.iter().find(|row| row.input_torque.is_some())?;
    let torque = |row: &SeriesRow| row.input_torque.unwrap_or(f64::NAN);
    let [_, _, unit] = &result.units;
    let what = if unit == "N" { "force" } else { "torque" };
    let plot = Plot {
        x: time(),
        y: Axis::linear(format!("{what} of the input ({unit})")),
        series: by_record(result, rows, "input", torque),
        shaded: vec![],
    };
    let drawing = plot.draw("The input over time.")?;
    let explanation = format!("The measured input over the same time, as the {what} that it exerts.");
    let table = csv(&["record", "time_s", "input_torque"], rows, |row: &SeriesRow| {
        vec![row.record.to_string(), number(row.time_s), number(torque(row))]
    });
    Some(framed("input", "The input".to_owned(), explanation, drawing, table))
}

fn overview(result: &DiagnosisResult, rows: &[SeriesRow], worst: &Worst<'_>) -> Option<Figure> {
    let series = by_record(result, rows, "recorded", |row| row.observed);
    let plot = Plot { x: time(), y: observed_axis(result), series, shaded: vec![worst.span()] };
    let drawing = plot.draw("The record over time.")?;
    let explanation = format!(
        "The record, with times of the clock in force. Shaded: the stretch with the largest error of the \
         recalibrated simulator, enlarged below.{}",
        left_out(result, rows).map_or_else(String::new, |said| format!(" {said}"))
    );
    let table = csv(&["record", "time_s", "observed"], rows, |row: &SeriesRow| {
        vec![row.record.to_string(), number(row.time_s), number(row.observed)]
    });
    Some(framed("record", "The record".to_owned(), explanation, drawing, table))
}

/// Smallest part of a record's end whose omission is stated.
const LEFT_OUT: f64 = 0.02;

/// Returns a sentence on the ends of records that no plot shows because nothing moves there.
fn left_out(result: &DiagnosisResult, rows: &[SeriesRow]) -> Option<String> {
    let still = |(index, record): (usize, &RecordRow)| {
        let number = index + 1;
        let own = rows.iter().filter(|row| row.record == number);
        let last = own.map(|row| row.time_s).fold(f64::NEG_INFINITY, f64::max);
        let left = record.duration_s - last;
        (last.is_finite() && left > LEFT_OUT * record.duration_s).then(|| {
            let which = if result.records.len() > 1 { format!(" of record {number}") } else { String::new() };
            format!("the last {}{which}", quantity(&significant(left, 3), "s"))
        })
    };
    let ends: Vec<String> = result.records.iter().enumerate().filter_map(still).collect();
    // A long record is thinned by whole stretches, and the last of them may be left out.
    let why = if result.samples_used < 0.9999 { "" } else { ", in which nothing moves visibly" };
    (!ends.is_empty()).then(|| format!("Not shown and not fitted: {}{why}.", listed(&ends, "and")))
}

/// Smallest step between samples, in units of the usual step, at which samples count as missing.
const GAP: f64 = 4.0;

/// Returns a line that breaks where time jumps: between records and where samples are missing.
fn pieces(rows: &[SeriesRow], value: impl Fn(&SeriesRow) -> f64) -> Vec<(f64, f64)> {
    let mut steps: Vec<f64> = rows.windows(2).map(pair_step).filter(|step| *step > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    let usual = steps.get(steps.len() / 2).copied().unwrap_or(f64::INFINITY);
    let mut points = Vec::with_capacity(rows.len());
    let mut last: Option<f64> = None;
    for row in rows {
        if last.is_some_and(|last| row.time_s - last > GAP * usual || row.time_s < last) {
            points.push(BREAK);
        }
        points.push((row.time_s, value(row)));
        last = Some(row.time_s);
    }
    points
}

fn pair_step(pair: &[SeriesRow]) -> f64 {
    match pair {
        [one, next] => next.time_s - one.time_s,
        _ => 0.0,
    }
}

fn zoom(result: &DiagnosisResult, worst: &Worst<'_>) -> Option<Figure> {
    let points = |value: fn(&SeriesRow) -> f64| pieces(worst.rows, value);
    let plot = Plot {
        x: time(),
        y: observed_axis(result),
        series: vec![
            recorded(Mark::Dots, points(|row| row.observed)),
            Simulator::Given.series(Mark::DottedLine, points(|row| row.nominal)),
            Simulator::Recalibrated.series(Mark::Dashes, points(|row| row.recalibrated)),
            Simulator::Repaired.series(Mark::Line, points(|row| row.repaired)),
        ],
        shaded: vec![],
    };
    let drawing = plot.draw("The worst stretch: record and simulators over time.")?;
    let (from, to) = worst.span();
    let title = format!(
        "The worst stretch: {} to {}{}",
        format::significant(from, 3),
        format::quantity(&format::significant(to, 3), "s"),
        if result.records.len() > 1 { format!(" of record {}", worst.record) } else { String::new() }
    );
    let explanation = "Record and simulators where the recalibrated simulator has its largest error. Each \
                       simulator starts this stretch from the initial state that fits best. Its coefficients \
                       were fitted to other stretches; the simulator as given keeps its own."
        .to_owned();
    let table =
        csv(&["time_s", "observed", "given", "recalibrated", "repaired"], worst.rows, |row: &SeriesRow| {
            [row.time_s, row.observed, row.nominal, row.recalibrated, row.repaired].map(number).to_vec()
        });
    Some(framed("worst-stretch", title, explanation, drawing, table))
}

fn residuals(result: &DiagnosisResult, rows: &[SeriesRow], worst: &Worst<'_>) -> Option<Figure> {
    let own: Vec<SeriesRow> = rows.iter().filter(|row| row.record == worst.record).copied().collect();
    let level = |height: f64| Series {
        label: "noise floor, two standard deviations".to_owned(),
        hue: Hue::Data,
        mark: Mark::DottedLevel,
        points: vec![(own.first().map_or(0.0, |row| row.time_s), height)],
    };
    let floor = 2.0 * result.gap.noise_floor;
    let plot = Plot {
        x: time(),
        y: Axis::linear(format!("record minus simulator ({})", result.gap.unit)),
        series: vec![
            Simulator::Recalibrated.series(Mark::Line, pieces(&own, |row| row.observed - row.recalibrated)),
            Simulator::Repaired.series(Mark::Line, pieces(&own, |row| row.observed - row.repaired)),
            level(floor),
            level(-floor),
        ],
        shaded: vec![worst.span()],
    };
    let drawing = plot.draw("Residuals before and after the repair, over time.")?;
    let title = if result.records.len() > 1 {
        format!("Residuals, record {}", worst.record)
    } else {
        "Residuals".to_owned()
    };
    let explanation =
        "The record minus each simulator, on stretches to which that simulator was not fitted. Residuals \
         within the dotted lines are noise; a wave beyond them is structure that the simulator lacks."
            .to_owned();
    let table = csv(&["time_s", "recalibrated", "repaired"], &own, |row: &SeriesRow| {
        [row.time_s, row.observed - row.recalibrated, row.observed - row.repaired].map(number).to_vec()
    });
    Some(framed("residuals", title, explanation, drawing, table))
}
