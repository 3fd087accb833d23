//! Plots of a run, each with an explanation and its data as CSV.

use std::borrow::Cow;

use results::{EnvelopeRow, TraceRow};

use crate::format;
use crate::parse::Run;
use crate::plot::{Axis, Drawing, Hue, Mark, Plot, Series};

/// Largest number of CSV rows under one plot; of longer tables only every n-th row is kept.
const MOST_ROWS: usize = 3_000;
/// Largest number of entries in one legend; the remaining ones are counted.
const MOST_ENTRIES: usize = 10;

/// A plot with its title, explanation, notes and data.
pub(crate) struct Figure {
    /// Name of the plot's anchor in the page.
    pub(crate) id: Cow<'static, str>,
    pub(crate) title: Cow<'static, str>,
    /// Content of the plot and how to read it.
    pub(crate) explanation: String,
    /// Statements on missing parts of the plot.
    pub(crate) notes: Vec<String>,
    pub(crate) drawing: Drawing,
    /// Drawn data as a CSV table, followed by its number of rows in words.
    pub(crate) csv: String,
    pub(crate) rows: String,
}

pub(crate) fn figures(run: &Run) -> Vec<Figure> {
    [envelope(run), residuals(run), loss(run), decay_rate(run), distance(run)].into_iter().flatten().collect()
}

/// Takes the first plot for the top of the page, below the verdict.
pub(crate) fn lead(figures: &mut Vec<Figure>) -> Vec<Figure> {
    let first = figures.len().min(1);
    figures.drain(..first).collect()
}

fn envelope(run: &Run) -> Option<Figure> {
    let rows = &run.envelope;
    let plot = Plot {
        x: time_axis(),
        y: Axis::linear(format!("ln(A / {})", run.result.data.unit)),
        series: vec![
            estimate(run, Mark::Line, rows.iter().map(|r| (r.time_s, r.estimate))),
            oracle(Mark::Dashes, rows.iter().map(|r| (r.time_s, r.oracle))),
            Series {
                label: "peaks of the record".into(),
                hue: Hue::Data,
                mark: Mark::Dots,
                points: rows.iter().map(|r| (r.time_s, r.log_amplitude)).collect(),
            },
        ],
        shaded: vec![],
    };
    let title = "Envelope";
    let explanation = "Each dot is the amplitude at a peak of the record, or in a window of its samples. On this scale the decay of a single \
                       damping ratio is a straight line, and its slope is −λ.";
    let csv = csv(&["time_s", "log_amplitude", "oracle", "estimate"], rows, |r: &EnvelopeRow| {
        numbers(&[r.time_s, r.log_amplitude, r.oracle, r.estimate])
    });
    figure("envelope", title, explanation, &plot, csv)
}

fn residuals(run: &Run) -> Option<Figure> {
    let rows = &run.envelope;
    let plot = Plot {
        x: time_axis(),
        y: Axis::linear("ln A less the reference line"),
        series: vec![
            estimate(run, Mark::Line, rows.iter().map(|r| (r.time_s, r.estimate - r.oracle))),
            oracle(Mark::Level, [(0.0, 0.0)].into_iter()),
            Series {
                label: "peaks of the record".into(),
                hue: Hue::Data,
                mark: Mark::Dots,
                points: rows.iter().map(|r| (r.time_s, r.log_amplitude - r.oracle)).collect(),
            },
        ],
        shaded: vec![],
    };
    let title = "Residuals";
    let explanation = "The same peaks with the reference line subtracted: dots scattered evenly about zero \
                       support a single damping ratio; a bend or a wave is evidence against it. If the \
                       estimator agrees with the reference, its line lies on zero.";
    let csv = csv(&["time_s", "residual", "estimate_less_oracle"], rows, |r: &EnvelopeRow| {
        numbers(&[r.time_s, r.log_amplitude - r.oracle, r.estimate - r.oracle])
    });
    figure("residuals", title, explanation, &plot, csv)
}

fn loss(run: &Run) -> Option<Figure> {
    let mut names: Vec<&str> = Vec::new();
    let mut series = Vec::new();
    for phase in phases(&run.trace) {
        let name = phase.name();
        let index = names.iter().position(|n| *n == name).unwrap_or(names.len());
        if index == names.len() {
            names.push(name);
        }
        series.push(Series {
            label: name.to_owned(),
            hue: Hue::of_series(index),
            // The hues repeat after four phases; the next four differ by their dashes.
            mark: if (index / 4).is_multiple_of(2) { Mark::Line } else { Mark::Dashes },
            points: phase.points(|row| row.loss),
        });
    }
    let plot =
        Plot { x: step_axis(), y: Axis::log("loss (scaled units)"), series, shaded: shaded(&run.trace) };
    let title = "Loss";
    let explanation = "The quantity that the training minimizes. Phases may weight its terms differently, so \
                       only the decrease within a phase counts, not a jump between phases.";
    let csv = trace_csv(run, "loss", |row| row.loss);
    figure("loss", title, explanation, &plot, csv)
}

fn decay_rate(run: &Run) -> Option<Figure> {
    let first = run.trace.first()?;
    let level = [(first.step as f64, run.result.oracle.decay_rate)];
    let plot = Plot {
        x: step_axis(),
        y: Axis::linear("λ (1/s)"),
        series: vec![estimate_steps(run, |row| row.decay_rate), oracle(Mark::Level, level.into_iter())],
        shaded: shaded(&run.trace),
    };
    let title = "Decay rate";
    let explanation = "λ during the training; the dashed line is the value of closed-form least squares on \
                       the same envelope.";
    let csv = trace_csv(run, "decay_rate", |row| row.decay_rate);
    figure("decay-rate", title, explanation, &plot, csv)
}

fn distance(run: &Run) -> Option<Figure> {
    let first = run.trace.first()?;
    let reference = run.result.oracle.decay_rate;
    let relative = move |row: &TraceRow| (row.decay_rate / reference - 1.0).abs();
    let level = |label: &str, hue, mark, height: f64| Series {
        label: label.to_owned(),
        hue,
        mark,
        points: vec![(first.step as f64, height)],
    };
    let plot = Plot {
        x: step_axis(),
        y: Axis::log("|λ / reference λ − 1|"),
        series: vec![
            estimate_steps(run, relative),
            level("stated tolerance", Hue::Data, Mark::Level, run.result.tolerance_percent / 100.0),
            level(
                "standard error of the reference λ",
                Hue::Oracle,
                Mark::DottedLevel,
                (run.result.oracle.std_error / reference).abs(),
            ),
        ],
        shaded: shaded(&run.trace),
    };
    let title = "Digits gained";
    let explanation = "The distance of λ from that of the reference: each decade down is one more digit that \
                       both share. Below the dotted line, more digits show only how well the training solves \
                       the fit; they say nothing about the oscillator.";
    let csv = trace_csv(run, "relative_distance", relative);
    figure("digits", title, explanation, &plot, csv)
}

pub(crate) fn figure(
    id: impl Into<Cow<'static, str>>,
    title: impl Into<Cow<'static, str>>,
    explanation: &str,
    plot: &Plot,
    (csv, rows): (String, String),
) -> Option<Figure> {
    let (id, title) = (id.into(), title.into());
    let description = format!("{title}: {} against {}.", plot.y.label, plot.x.label);
    let mut drawing = plot.draw(&description)?;
    let mut notes = Vec::new();
    if drawing.legend.len() > MOST_ENTRIES {
        notes.push(format!("{} more phases are not in the legend.", drawing.legend.len() - MOST_ENTRIES));
        drawing.legend.truncate(MOST_ENTRIES);
    }
    let left_out = drawing.left_out;
    if left_out > 0 {
        notes.push(format!(
            "Values without a place on these axes (not finite, or not positive on a logarithmic \
             axis) are left out: {left_out}."
        ));
    }
    Some(Figure { id, title, explanation: explanation.to_owned(), notes, drawing, csv, rows })
}

pub(crate) fn time_axis() -> Axis {
    Axis::linear("time after the first peak (s)")
}

fn step_axis() -> Axis {
    Axis::linear("training step")
}

pub(crate) fn oracle(mark: Mark, points: impl Iterator<Item = (f64, f64)>) -> Series {
    Series { label: "reference (least squares)".into(), hue: Hue::Oracle, mark, points: points.collect() }
}

fn estimate(run: &Run, mark: Mark, points: impl Iterator<Item = (f64, f64)>) -> Series {
    Series { label: run.result.estimator_title.clone(), hue: Hue::Estimate, mark, points: points.collect() }
}

fn estimate_steps(run: &Run, value: impl Fn(&TraceRow) -> f64) -> Series {
    let points = run.trace.iter().map(|row| (row.step as f64, value(row)));
    estimate(run, Mark::Line, points)
}

/// Consecutive rows of a trace in the same phase; never empty.
struct Phase<'a> {
    rows: &'a [TraceRow],
}

impl<'a> Phase<'a> {
    fn name(&self) -> &'a str {
        self.rows.first().map_or("", |row| row.phase.as_str())
    }

    fn start(&self) -> f64 {
        self.rows.first().map_or(0.0, |row| row.step as f64)
    }

    fn end(&self) -> f64 {
        self.rows.last().map_or(0.0, |row| row.step as f64)
    }

    fn points(&self, value: impl Fn(&TraceRow) -> f64) -> Vec<(f64, f64)> {
        self.rows.iter().map(|row| (row.step as f64, value(row))).collect()
    }
}

fn phases(trace: &[TraceRow]) -> Vec<Phase<'_>> {
    trace.chunk_by(|one, next| one.phase == next.phase).map(|rows| Phase { rows }).collect()
}

/// Returns every other phase, from its first step to that of the next phase.
fn shaded(trace: &[TraceRow]) -> Vec<(f64, f64)> {
    let phases = phases(trace);
    phases
        .iter()
        .enumerate()
        .filter(|(index, _)| !index.is_multiple_of(2))
        .map(|(index, phase)| {
            let end = phases.get(index + 1).map_or(phase.end(), Phase::start);
            (phase.start(), end)
        })
        .collect()
}

fn trace_csv(run: &Run, column: &str, value: impl Fn(&TraceRow) -> f64) -> (String, String) {
    csv(&["step", "phase", column], &run.trace, |row| {
        vec![row.step.to_string(), row.phase.clone(), number(value(row))]
    })
}

fn numbers(values: &[f64]) -> Vec<String> {
    values.iter().map(|value| number(*value)).collect()
}

/// Formats a number with as few digits as read back as the same double.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 || (1e-4..1e15).contains(&value.abs()) { value.to_string() } else { format!("{value:e}") }
}

/// Returns the table as CSV text, and its number of rows in words.
pub(crate) fn csv<Row>(
    header: &[&str],
    rows: &[Row],
    fields: impl Fn(&Row) -> Vec<String>,
) -> (String, String) {
    let stride = rows.len().div_ceil(MOST_ROWS).max(1);
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing to memory does not fail; if it did, the table would end early.
    let mut written = writer.write_record(header).is_ok();
    for row in rows.iter().step_by(stride) {
        written = written && writer.write_record(fields(row)).is_ok();
    }
    let bytes = writer.into_inner().unwrap_or_default();
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let total = format::count(u64::try_from(rows.len()).unwrap_or(u64::MAX));
    let shown = match (written, stride) {
        (false, _) => "incomplete".to_owned(),
        (true, 1) => format!("{total} rows"),
        (true, _) => format!("one row in {stride} of {total}"),
    };
    (text, shown)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(step: u64, phase: &str) -> TraceRow {
        TraceRow { step, phase: phase.into(), loss: 1.0, decay_rate: 0.1 }
    }

    #[test]
    fn every_other_phase_is_shaded_up_to_the_next() {
        let trace = [row(0, "a"), row(1, "b"), row(2, "b"), row(3, "c"), row(4, "d"), row(5, "d")];
        assert_eq!(shaded(&trace), [(1.0, 3.0), (4.0, 5.0)]);
    }

    #[test]
    fn long_tables_keep_every_so_many_rows() {
        let trace: Vec<_> = (0..5_000).map(|step| row(step, "a,b")).collect();
        let (text, shown) = csv(&["step", "phase"], &trace, |r| vec![r.step.to_string(), r.phase.clone()]);
        assert_eq!(shown, "one row in 2 of 5000");
        assert_eq!(text.lines().count(), 1 + 2_500);
        assert!(text.starts_with("step,phase\n0,\"a,b\"\n2,"));
    }
}
