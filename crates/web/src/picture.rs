//! Plots of a record, drawn by the crate of the reports.

use record::{Look, Quantity};
use report::plot::{Axis, Drawing, Hue, Mark, Plot, Series};
use serde_json::{Value, json};

/// Draws the record over time, with the part that is read shaded if it is not all of it, and its input.
pub(crate) fn picture(look: &Look) -> Vec<Value> {
    let (record, reading) = (&look.record, &look.source.reading);
    let times = || look.clock.times_s.iter().copied();
    let line = |label: &str, hue: Hue, points: Vec<(f64, f64)>| Series {
        label: label.to_owned(),
        hue,
        mark: Mark::Line,
        points,
    };
    let plot = |label: String, series: Series, shaded: Vec<(f64, f64)>| Plot {
        x: Axis::linear("time (s)"),
        y: Axis::linear(label),
        series: vec![series],
        shaded,
    };
    let observed = match (&reading.whole, reading.part_s) {
        (Some(whole), Some([from, to])) => {
            let points = whole.outline.iter().map(|[time, value]| (*time, *value)).collect();
            plot(axis(look), line("recorded", Hue::Data, points), vec![(from, to)])
        }
        _ => {
            let points = times().zip(record.values().iter().copied()).collect();
            plot(axis(look), line("recorded", Hue::Data, points), Vec::new())
        }
    };
    let input = record.input().map(|input| {
        let points = times().zip(input.iter().copied()).collect();
        let title = reading.input.as_ref().map_or("input", |read| read.column.as_str());
        plot(format!("input: {title}"), line("input", Hue::Second, points), Vec::new())
    });
    let observed = observed.draw("The record over time.").map(|drawing| shown("record", &drawing));
    let input =
        input.and_then(|plot| plot.draw("The input over time.")).map(|drawing| shown("input", &drawing));
    observed.into_iter().chain(input).collect()
}

fn shown(what: &str, drawing: &Drawing) -> Value {
    json!({ "what": what, "wide": drawing.wide, "narrow": drawing.narrow })
}

/// Returns the label of the observed quantity with its unit.
fn axis(look: &Look) -> String {
    let unit = look.record.unit();
    let what = match (look.record.quantity(), unit) {
        (Quantity::Position, "rad") => "angle",
        (Quantity::Position, _) => "displacement",
        (quantity, _) => quantity.name(),
    };
    format!("{what} ({unit})")
}
