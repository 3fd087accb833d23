//! The plots of a comparison: the paper's Figure 1, a to c; the one with the answer, c, comes first.

use results::{EnvelopeRow, MethodRow};

use crate::figures::{Figure, csv, figure, number, oracle, time_axis};
use crate::format;
use crate::parse::Comparison;
use crate::plot::{Axis, DotRow, DotRows, Hue, Mark, Plot, Series};

/// Errors below this, in percent, are drawn at it: the spacing of doubles, where digits end.
const LEAST_PERCENT: f64 = 100.0 * f64::EPSILON;

pub(super) fn figures(comparison: &Comparison) -> Vec<Figure> {
    [errors(comparison), amplitude(comparison), log_amplitude(comparison)].into_iter().flatten().collect()
}

fn amplitude(comparison: &Comparison) -> Option<Figure> {
    // An angle in degrees, as the paper has it.
    let (scale, unit) = match comparison.result.data.unit.as_str() {
        "rad" => (180.0 / std::f64::consts::PI, "degrees"),
        unit => (1.0, unit),
    };
    let rows = &comparison.envelope;
    let size = |logarithm: f64| scale * logarithm.exp();
    let plot = Plot {
        x: time_axis(),
        y: Axis::linear(format!("amplitude A ({unit})")),
        series: vec![
            oracle(Mark::Line, rows.iter().map(|row| (row.time_s, size(row.oracle)))),
            peaks(rows.iter().map(|row| (row.time_s, size(row.log_amplitude)))),
        ],
        shaded: vec![],
    };
    let explanation = "Each dot is a peak of the record; the line is A₀ exp(−λt) with the A₀ and λ of \
                       certified least squares on ln A.";
    let csv = csv(&["time_s", "amplitude", "fit"], rows, |row: &EnvelopeRow| {
        [row.time_s, size(row.log_amplitude), size(row.oracle)].map(number).into()
    });
    figure("amplitude", "(a) Decay of the amplitude", explanation, &plot, csv)
}

fn log_amplitude(comparison: &Comparison) -> Option<Figure> {
    let rows = &comparison.envelope;
    let plot = Plot {
        x: time_axis(),
        y: Axis::linear(format!("ln(A / {})", comparison.result.data.unit)),
        series: vec![
            oracle(Mark::Line, rows.iter().map(|row| (row.time_s, row.oracle))),
            peaks(rows.iter().map(|row| (row.time_s, row.log_amplitude))),
        ],
        shaded: vec![],
    };
    let explanation = "The same peaks on a logarithmic scale, on which every method fits a line with slope \
                       −λ. Dots that bend away from the line systematically are evidence against a single \
                       damping ratio.";
    let csv = csv(&["time_s", "log_amplitude", "fit"], rows, |row: &EnvelopeRow| {
        [row.time_s, row.log_amplitude, row.oracle].map(number).into()
    });
    figure("log-amplitude", "(b) Logarithm of the amplitude", explanation, &plot, csv)
}

fn errors(comparison: &Comparison) -> Option<Figure> {
    let result = &comparison.result;
    let plot = DotRows {
        x: Axis::log("difference from certified least squares in ζ (%)"),
        rows: result.results.iter().map(dot_row).collect(),
        value_label: "first seed".into(),
        extreme_label: "worst seed".into(),
        level: Some(("stated tolerance".into(), result.tolerance_percent)),
    };
    let title = "Figure 1 (c): error by method";
    let drawing = plot.draw(&format!("{title}: {}, one row for each method.", plot.x.label))?;
    let mut notes = Vec::new();
    if errors_of(&result.results).any(|error| error < LEAST_PERCENT) {
        notes.push(format!(
            "Errors below {}, the precision of a double, are drawn at this value, including zero.",
            format::percent(LEAST_PERCENT)
        ));
    }
    let silent = result.results.iter().filter(|row| row.outcome.estimate().is_none()).count();
    if silent > 0 {
        notes.push(format!("Rows without a mark gave no estimate: {silent}."));
    }
    if drawing.left_out > 0 {
        notes.push(format!("Errors that are not finite have no mark: {}.", drawing.left_out));
    }
    let header =
        ["number", "method", "error_percent", "median_error_percent", "worst_error_percent", "seeds"];
    let (csv, rows) = csv(&header, &result.results, |row: &MethodRow| {
        let mut fields = vec![row.number.map_or_else(String::new, |n| n.to_string()), row.id.clone()];
        match row.outcome.estimate() {
            Some(found) => {
                let errors = [found.error_percent, found.median_error_percent, found.worst_error_percent];
                fields.extend(errors.map(number));
                fields.push(found.seeds.to_string());
            }
            None => fields.extend(std::iter::repeat_n(String::new(), 4)),
        }
        fields
    });
    let explanation = "Each decade to the left is one more digit of ζ that a method shares with certified \
                       least squares. The distance shows how well a method solves the fit; it says nothing \
                       about the oscillator."
        .to_owned();
    Some(Figure { id: "errors".into(), title: title.into(), explanation, notes, drawing, csv, rows })
}

fn dot_row(row: &MethodRow) -> DotRow {
    // `max` would turn a value that is no number into one.
    let drawn = |error: f64| if error < LEAST_PERCENT { LEAST_PERCENT } else { error };
    DotRow {
        name: match row.number {
            Some(number) => format!("{number} {}", row.title),
            None => row.title.clone(),
        },
        value: row.outcome.estimate().map(|found| drawn(found.error_percent)),
        extreme: row.outcome.estimate().map(|found| drawn(found.worst_error_percent)),
        interval: None,
    }
}

fn errors_of(rows: &[MethodRow]) -> impl Iterator<Item = f64> + '_ {
    rows.iter()
        .filter_map(|row| row.outcome.estimate())
        .flat_map(|found| [found.error_percent, found.worst_error_percent])
}

fn peaks(points: impl Iterator<Item = (f64, f64)>) -> Series {
    Series { label: "peaks of the record".into(), hue: Hue::Data, mark: Mark::Dots, points: points.collect() }
}
