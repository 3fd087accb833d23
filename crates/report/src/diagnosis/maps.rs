//! Maps of the gap over time, amplitude, the phase plane and frequency.

use results::{DiagnosisResult, MapCell};

use super::figures::{Simulator, framed};
use crate::figures::{Figure, csv, number};
use crate::plot::{Axis, BREAK, HeatCell, HeatMap, Hue, Mark, Plot, Series};

/// Number of cells of the spectrum shown beyond the last significant one.
const BEYOND: usize = 6;

pub(super) fn figures(result: &DiagnosisResult) -> Vec<Figure> {
    let [position, velocity, _] = &result.units;
    let place = &result.place;
    [
        along(
            result,
            "gap-over-time",
            "The gap over time",
            Axis::linear("time (s)"),
            Scale::Linear,
            &place.time,
            "A gap that fades with the swing depends on amplitude; one that stays or grows depends on time.",
        ),
        along(
            result,
            "gap-over-amplitude",
            "The gap over amplitude",
            Axis::linear(format!("amplitude of the swing ({position})")),
            Scale::Linear,
            &place.amplitude,
            "Stiffening, gravity and drag grow with amplitude; dry friction and play matter most where the swing is \
             small.",
        ),
        phase(result, position, velocity),
        along(
            result,
            "gap-over-frequency",
            "The gap over frequency",
            Axis::linear("angular frequency (rad/s)"),
            Scale::Log,
            spectrum(&place.frequency),
            "A peak at the swing’s own frequency means a wrong phase or loss, peaks at its multiples mean a \
             nonlinear effect, and a line elsewhere means an external vibration or a second mode.",
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}

enum Scale {
    Linear,
    Log,
}

/// Returns the informative part of a spectrum: beyond the last significant cell it is noise up to half the
/// sampling rate.
fn spectrum(cells: &[MapCell]) -> &[MapCell] {
    // Without a significant cell, the first cells represent the rest.
    let last = cells.iter().rposition(|cell| cell.significant).map_or(1, |last| last + 1);
    cells.split_at((last + BEYOND).min(cells.len())).0
}

/// Returns the cells along one axis as steps, interrupted where cells are apart or empty.
fn stairs(cells: &[MapCell], value: impl Fn(&MapCell) -> f64) -> Vec<(f64, f64)> {
    let mut points = Vec::with_capacity(2 * cells.len());
    let mut last = f64::NEG_INFINITY;
    for cell in cells {
        let [from, to] = cell.bounds.first().copied().unwrap_or([f64::NAN; 2]);
        let room = 1e-6 * (to - from);
        if from > last + room || cell.samples == 0 {
            points.push(BREAK);
        }
        if cell.samples > 0 {
            points.extend([from, to].map(|end| (end, value(cell))));
        }
        last = to;
    }
    points
}

fn along(
    result: &DiagnosisResult,
    id: &'static str,
    title: &str,
    x: Axis,
    scale: Scale,
    cells: &[MapCell],
    reading: &str,
) -> Option<Figure> {
    let label = format!("RMS of the residual ({})", result.gap.unit);
    let significant = cells.iter().filter(|cell| cell.significant);
    let marked = significant.filter_map(|cell| {
        let [from, to] = cell.bounds.first().copied()?;
        Some((0.5 * (from + to), cell.value))
    });
    let plot = Plot {
        x,
        y: match scale {
            Scale::Linear => Axis::linear(label),
            Scale::Log => Axis::log(label),
        },
        series: vec![
            Series {
                label: "significance band (5 % false alarms over all cells)".to_owned(),
                hue: Hue::Data,
                mark: Mark::DottedLine,
                points: stairs(cells, |cell| cell.band),
            },
            Simulator::Recalibrated.series(Mark::Line, stairs(cells, |cell| cell.value)),
            Simulator::Repaired.series(Mark::Line, stairs(cells, |cell| cell.repaired)),
            Series {
                label: "significant".to_owned(),
                hue: Hue::Oracle,
                mark: Mark::Dots,
                points: marked.collect(),
            },
        ],
        shaded: vec![],
    };
    let drawing = plot.draw(&format!("{title}, with its significance band."))?;
    let count = cells.iter().filter(|cell| cell.significant).count();
    let explanation = format!(
        "{reading} Above the dotted band, the recalibrated simulator’s error is more than noise; this is the \
         case in {count} of {} cells.",
        cells.len()
    );
    Some(framed(id, title.to_owned(), explanation, drawing, table(cells)))
}

fn phase(result: &DiagnosisResult, position: &str, velocity: &str) -> Option<Figure> {
    let cells = &result.place.phase;
    let map = HeatMap {
        x: Axis::linear(format!("position ({position})")),
        y: Axis::linear(format!("velocity ({velocity})")),
        cells: cells
            .iter()
            .filter_map(|cell| match cell.bounds.as_slice() {
                [x, y] => Some(HeatCell { x: *x, y: *y, value: cell.value, outlined: cell.significant }),
                _ => None,
            })
            .collect(),
        unit: result.gap.unit.clone(),
        outline: "significant".to_owned(),
    };
    let drawing = map.draw("The gap over position and velocity.")?;
    let explanation = "RMS error of the recalibrated simulator by position and velocity: the deeper the \
                       color, the larger the error. Left and right are the turning points, top and bottom \
                       the fastest passages. Outlined cells lie above the level that noise alone exceeds in \
                       any of the cells with 5 % probability."
        .to_owned();
    Some(framed(
        "gap-in-the-phase-plane",
        "The gap in the phase plane".to_owned(),
        explanation,
        drawing,
        table(cells),
    ))
}

fn table(cells: &[MapCell]) -> (String, String) {
    let header = ["bounds", "recalibrated", "repaired", "band", "significant", "samples"];
    csv(&header, cells, |cell: &MapCell| {
        let bounds: Vec<String> =
            cell.bounds.iter().map(|[from, to]| format!("{}..{}", number(*from), number(*to))).collect();
        vec![
            bounds.join(" "),
            number(cell.value),
            number(cell.repaired),
            number(cell.band),
            cell.significant.to_string(),
            cell.samples.to_string(),
        ]
    })
}
