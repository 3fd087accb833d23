//! Plots of one problem of a prediction study.

use results::{PredictionCsvRow, PredictionRow, ProblemRow, ProblemStudy, SplitKind};

use super::scores::error;
use super::study::scored;
use crate::figures::{Figure, csv, figure, number, time_axis};
use crate::plot::{Axis, DotRow, DotRows, Hue, Mark, Plot, Series};

/// Largest number of methods whose functions are drawn.
const MOST_FUNCTIONS: usize = 3;
/// Name of the best exponential in `predictions.csv`.
const EXPONENTIAL: &str = "best-exponential";
/// Relative difference below which two errors count as those of the same line.
const EQUAL: f64 = 1e-6;

/// A drawn function: the method's title, and ln A at the times of the peaks.
struct Function<'a> {
    title: &'a str,
    values: Vec<f64>,
}

/// Peaks of the split at the end, in the order of time.
struct Peaks<'a> {
    rows: Vec<&'a PredictionCsvRow>,
    exponential: Vec<f64>,
    functions: Vec<Function<'a>>,
}

pub(super) fn figures(
    anchor: &str,
    problem: &ProblemRow,
    study: &ProblemStudy,
    rows: &[PredictionCsvRow],
) -> Vec<Figure> {
    let peaks = peaks(problem, study, rows);
    [
        peaks.as_ref().and_then(|peaks| log_amplitude(anchor, problem, study, peaks)),
        peaks.as_ref().and_then(|peaks| deviations(anchor, problem, peaks)),
        errors(anchor, problem, study),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn peaks<'a>(
    problem: &ProblemRow,
    study: &'a ProblemStudy,
    rows: &'a [PredictionCsvRow],
) -> Option<Peaks<'a>> {
    let of = |method: &str| -> Vec<&'a PredictionCsvRow> {
        rows.iter()
            .filter(|row| {
                row.problem == problem.id && row.split == SplitKind::Extrapolation && row.method == method
            })
            .collect()
    };
    let own = of(EXPONENTIAL);
    let reference = study.exponential.extrapolation.rms_log_error;
    let functions = study
        .methods
        .iter()
        .filter(|row| error(row).is_finite() && (error(row) - reference).abs() > EQUAL * reference)
        .map(|row| (row, of(&row.id)))
        .filter(|(_, found)| found.len() == own.len())
        .take(MOST_FUNCTIONS)
        .map(|(row, found)| Function {
            title: &row.title,
            values: found.iter().map(|row| row.predicted).collect(),
        })
        .collect();
    let exponential = own.iter().map(|row| row.predicted).collect();
    (!own.is_empty()).then_some(Peaks { rows: own, exponential, functions })
}

impl Peaks<'_> {
    /// Returns the series of a plot; `place` maps the number of a peak and its value to a vertical place.
    fn series(&self, place: impl Fn(usize, f64) -> f64) -> Vec<Series> {
        let points = |values: &mut dyn Iterator<Item = f64>| -> Vec<(f64, f64)> {
            let times = self.rows.iter().map(|row| row.time_s);
            times.zip(values).enumerate().map(|(index, (time, value))| (time, place(index, value))).collect()
        };
        let mut series = vec![Series {
            label: "best exponential".into(),
            hue: Hue::Oracle,
            mark: Mark::Line,
            points: points(&mut self.exponential.iter().copied()),
        }];
        for (index, function) in self.functions.iter().enumerate() {
            series.push(Series {
                label: function.title.to_owned(),
                hue: Hue::of_series(index),
                // Two forms of one method may coincide.
                mark: if index.is_multiple_of(2) { Mark::Line } else { Mark::Dashes },
                points: points(&mut function.values.iter().copied()),
            });
        }
        if self.rows.iter().all(|row| row.truth.is_some()) {
            series.push(Series {
                label: "noise-free truth".into(),
                hue: Hue::Ink,
                mark: Mark::DottedLine,
                points: points(&mut self.rows.iter().filter_map(|row| row.truth)),
            });
        }
        let all = points(&mut self.rows.iter().map(|row| row.log_amplitude));
        for (label, hue, held_out) in
            [("peaks fitted", Hue::Data, false), ("peaks held out", Hue::Fourth, true)]
        {
            let chosen = all.iter().zip(&self.rows).filter(|(_, row)| row.held_out == held_out);
            series.push(Series {
                label: label.into(),
                hue,
                mark: Mark::Dots,
                points: chosen.map(|(point, _)| *point).collect(),
            });
        }
        series
    }

    /// Returns the stretch of time that was held out.
    fn shaded(&self) -> Vec<(f64, f64)> {
        let mut held = self.rows.iter().filter(|row| row.held_out).map(|row| row.time_s);
        let first = held.next();
        let last = held.next_back();
        first.zip(last).into_iter().collect()
    }

    fn csv(&self) -> (String, String) {
        let mut header = vec!["time_s", "log_amplitude", "held_out", "best_exponential"];
        header.extend(self.functions.iter().map(|function| function.title));
        let indices: Vec<usize> = (0..self.rows.len()).collect();
        let at = |values: &[f64], index: usize| number(values.get(index).copied().unwrap_or(f64::NAN));
        csv(&header, &indices, |&index| {
            let mut fields = self.rows.get(index).map_or_else(Vec::new, |row| {
                vec![number(row.time_s), number(row.log_amplitude), row.held_out.to_string()]
            });
            fields.push(at(&self.exponential, index));
            fields.extend(self.functions.iter().map(|function| at(&function.values, index)));
            fields
        })
    }
}

/// Returns the name of the record under a plot; it always distinguishes simulated from measured records.
fn named(problem: &ProblemRow) -> String {
    format!("{} ({})", problem.title, crate::verdict::kind(problem.origin))
}

fn log_amplitude(
    anchor: &str,
    problem: &ProblemRow,
    study: &ProblemStudy,
    peaks: &Peaks<'_>,
) -> Option<Figure> {
    let plot = Plot {
        x: time_axis(),
        y: Axis::linear(format!("ln(A / {})", study.unit)),
        series: peaks.series(|_, value| value),
        shaded: peaks.shaded(),
    };
    let explanation = "Methods are fitted to the gray peaks and extrapolate over the shaded stretch, which \
                       no method saw. The plot shows the best exponential and, of the methods with different \
                       lines, the three with the smallest errors there; for a simulation, it shows the first \
                       draw.";
    figure(
        format!("{anchor}-envelope"),
        format!("Envelope: {}", named(problem)),
        explanation,
        &plot,
        peaks.csv(),
    )
}

fn deviations(anchor: &str, problem: &ProblemRow, peaks: &Peaks<'_>) -> Option<Figure> {
    let less = |index: usize, value: f64| value - peaks.exponential.get(index).copied().unwrap_or(f64::NAN);
    let plot = Plot {
        x: time_axis(),
        y: Axis::linear("ln A less the best exponential"),
        series: peaks.series(less),
        shaded: peaks.shaded(),
    };
    let explanation = "The same with the best exponential subtracted: where the envelope bends, the peaks \
                       depart from zero, and a method that has found the bend follows them into the shaded \
                       stretch.";
    figure(
        format!("{anchor}-deviations"),
        format!("Deviations: {}", named(problem)),
        explanation,
        &plot,
        peaks.csv(),
    )
}

fn errors(anchor: &str, problem: &ProblemRow, study: &ProblemStudy) -> Option<Figure> {
    let inside = |row: &PredictionRow| {
        scored(row).and_then(|scores| Some(scores.interpolation.as_ref()?.rms_log_error))
    };
    let beyond = |row: &PredictionRow| {
        scored(row).and_then(|scores| Some(scores.extrapolation.as_ref()?.rms_log_error))
    };
    let plot = DotRows {
        x: Axis::log("RMS error of ln A on held-out peaks"),
        rows: study
            .methods
            .iter()
            .map(|row| DotRow {
                name: row.title.clone(),
                value: inside(row),
                extreme: beyond(row),
                interval: None,
            })
            .collect(),
        value_label: "inside".into(),
        extreme_label: "beyond".into(),
        level: Some(("best exponential, beyond".into(), study.exponential.extrapolation.rms_log_error)),
    };
    let title = format!("Errors by method: {}", named(problem));
    let drawing = plot.draw(&format!("{title}: {}, one row for each method.", plot.x.label))?;
    let mut notes = Vec::new();
    let silent = study.methods.iter().filter(|row| inside(row).or(beyond(row)).is_none()).count();
    if silent > 0 {
        notes.push(format!("Rows without a mark made no prediction: {silent}."));
    }
    if drawing.left_out > 0 {
        notes.push(format!("Errors that are not finite have no mark: {}.", drawing.left_out));
    }
    let (csv, rows) = csv(&["method", "error_inside", "error_beyond"], &study.methods, |row| {
        let cell = |value: Option<f64>| value.map_or_else(String::new, number);
        vec![row.id.clone(), cell(inside(row)), cell(beyond(row))]
    });
    Some(Figure {
        id: format!("{anchor}-errors").into(),
        title: title.into(),
        explanation:
            "If a dot is left of its ring, the method predicts better between other peaks than beyond the \
             last one; if a ring is left of the dashed line, it predicts better beyond the last peak than \
             the best exponential."
                .to_owned(),
        notes,
        drawing,
        csv,
        rows,
    })
}
