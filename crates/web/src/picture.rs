//! Plots of a record, drawn by the crate of the reports.

use record::{Look, Quantity, Unit};
use report::plot::{Axis, Drawing, Hue, Mark, Plot, Series};
use serde_json::{Value, json};
use workflow::look::Looked;
use workflow::mode_rows;

/// Draws the record over time, with the part that is read shaded if it is not all of it, its input, and its spectrum with
/// the modes.
pub(crate) fn pictures(found: &Looked) -> Vec<Value> {
    let look = &found.look;
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
    let (label, scale) = axis(look);
    let points: Vec<(f64, f64)> = times().zip(record.values().iter().map(|value| scale * value)).collect();
    let modes: Vec<(f64, bool)> = if found.modes.is_empty() {
        found
            .oscillator
            .natural_frequency_hz()
            .map(|frequency| (frequency.value, false))
            .into_iter()
            .collect()
    } else {
        mode_rows(&found.modes).iter().map(|mode| (mode.frequency_hz.value, mode.steady)).collect()
    };
    // Without a natural frequency there is nothing to mark.
    let spectrum = (!modes.is_empty()).then(|| report::spectrum_plot(&points, &modes, &label)).flatten();
    let observed = match (&reading.whole, reading.part_s) {
        (Some(whole), Some([from, to])) => {
            let points = whole.outline.iter().map(|[time, value]| (*time, scale * value)).collect();
            plot(label, line("recorded", Hue::Data, points), vec![(from, to)])
        }
        _ => plot(label, line("recorded", Hue::Data, points), Vec::new()),
    };
    let input = record.input().map(|input| {
        let points = times().zip(input.iter().copied()).collect();
        let title = reading.input.as_ref().map_or("input", |read| read.column.as_str());
        plot(format!("input: {title}"), line("input", Hue::Second, points), Vec::new())
    });
    [
        ("record", Some(observed), "The record over time."),
        ("input", input, "The input over time."),
        ("spectrum", spectrum, "Spectrum: amplitude over frequency, with a dot at each mode."),
    ]
    .into_iter()
    .filter_map(|(what, plot, description)| Some(shown(what, &plot?.draw(description)?)))
    .collect()
}

fn shown(what: &str, drawing: &Drawing) -> Value {
    json!({ "what": what, "wide": drawing.wide, "narrow": drawing.narrow })
}

/// Returns the label of the observed quantity with the log's unit, and the factor from the record's values to it.
fn axis(look: &Look) -> (String, f64) {
    let si = look.record.unit();
    let own = look.source.reading.value.unit.as_deref().and_then(Unit::parse);
    let own = own.filter(|own| own.si() == si);
    let what = match (look.record.quantity(), own.or_else(|| Unit::parse(si))) {
        (Quantity::Position, Some(unit)) if unit.is_signal() => "signal",
        (Quantity::Position, Some(unit)) if unit.si() == "rad" => "angle",
        (Quantity::Position, _) => "displacement",
        (quantity, _) => quantity.name(),
    };
    let (symbol, scale) = own.map_or((si, 1.0), |own| (own.symbol(), 1.0 / own.to_si()));
    (format!("{what} ({symbol})"), scale)
}
