//! Plots of the backbone curves and the restoring-force surface.

use results::{BackbonePoint, DiagnosisResult, SurfaceCell};

use super::figures::{Simulator, framed, recorded};
use crate::figures::{Figure, csv, number};
use crate::plot::{Axis, HeatCell, HeatMap, Mark, Plot};

/// Largest number of points of a backbone curve; each is the median of neighbors in amplitude.
const POINTS: usize = 40;
/// Smallest amplitude shown, in units of the noise floor.
const SMALLEST: f64 = 10.0;

pub(super) fn figures(result: &DiagnosisResult) -> Vec<Figure> {
    [
        backbone(
            result,
            "backbone-frequency",
            "Frequency against amplitude",
            "angular frequency (rad/s)",
            |point| Some(point.frequency),
            "The backbone curve, flat for a linear oscillator. Where it rises with amplitude the spring \
             stiffens; where it falls the spring softens, as with a hanging weight. The values are computed \
             for each cycle from its turning points; each dot is the median of cycles with neighboring \
             amplitudes. Amplitudes below 10 × noise are left out.",
        ),
        backbone(
            result,
            "backbone-decay",
            "Decay rate against amplitude",
            "decay rate (1/s)",
            |point| point.decay_rate,
            "How fast the swing dies at each amplitude. Viscous damping is flat; dry friction rises toward small \
             amplitudes, drag toward large ones.",
        ),
        surface(
            result,
            "restoring-force",
            "The restoring-force surface",
            |cell| cell.measured,
            "The measured acceleration as a function of position and velocity, without the part of the \
             input: the force law itself, per unit of inertia. For a linear spring, it is a plane that falls \
             from left to right.",
        ),
        surface(
            result,
            "missing-force",
            "What the force law lacks",
            |cell| cell.missing,
            "The measured acceleration minus that of the recalibrated simulator. A color that changes from \
             left to right is a force that depends on position; one that changes from bottom to top is a \
             loss. Scattered color is noise: accelerations are second differences of the record.",
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn backbone(
    result: &DiagnosisResult,
    id: &'static str,
    title: &str,
    label: &str,
    value: fn(&BackbonePoint) -> Option<f64>,
    explanation: &str,
) -> Option<Figure> {
    let curves = &result.backbone;
    if curves.measured.is_empty() {
        return None;
    }
    // Below, turning points are due to the noise.
    let least = SMALLEST * result.gap.noise_floor;
    let points = |of: &[BackbonePoint]| {
        let swings: Vec<BackbonePoint> =
            of.iter().filter(|point| point.amplitude >= least).copied().collect();
        medians(&swings, value)
    };
    let plot = Plot {
        x: Axis::linear(format!("amplitude ({})", result.gap.unit)),
        y: Axis::linear(label),
        series: vec![
            Simulator::Given.series(Mark::DottedLine, points(&curves.nominal)),
            Simulator::Repaired.series(Mark::Line, points(&curves.repaired)),
            recorded(Mark::Dots, points(&curves.measured)),
        ],
        shaded: vec![],
    };
    let drawing = plot.draw(&format!("{title}: measured, as given, repaired."))?;
    let named: Vec<(&str, &BackbonePoint)> =
        [("measured", &curves.measured), ("given", &curves.nominal), ("repaired", &curves.repaired)]
            .into_iter()
            .flat_map(|(name, points)| points.iter().map(move |point| (name, point)))
            .collect();
    let table = csv(&["of", "amplitude", "value"], &named, |(name, point): &(&str, &BackbonePoint)| {
        vec![(*name).to_owned(), number(point.amplitude), value(point).map_or_else(String::new, number)]
    });
    Some(framed(id, title.to_owned(), explanation.to_owned(), drawing, table))
}

/// Returns medians of neighbors in amplitude, by increasing amplitude.
fn medians(points: &[BackbonePoint], value: fn(&BackbonePoint) -> Option<f64>) -> Vec<(f64, f64)> {
    let mut pairs: Vec<(f64, f64)> =
        points.iter().filter_map(|point| Some((point.amplitude, value(point)?))).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let size = pairs.len().div_ceil(POINTS).max(1);
    pairs
        .chunks(size)
        .map(|chunk| {
            let median = |of: fn(&(f64, f64)) -> f64| {
                let mut values: Vec<f64> = chunk.iter().map(of).collect();
                values.sort_by(f64::total_cmp);
                values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
            };
            (median(|pair| pair.0), median(|pair| pair.1))
        })
        .collect()
}

fn surface(
    result: &DiagnosisResult,
    id: &'static str,
    title: &str,
    value: fn(&SurfaceCell) -> f64,
    explanation: &str,
) -> Option<Figure> {
    let [position, velocity, _] = &result.units;
    let map = HeatMap {
        x: Axis::linear(format!("position ({position})")),
        y: Axis::linear(format!("velocity ({velocity})")),
        cells: result
            .surface
            .iter()
            .map(|cell| {
                let [x, y] = cell.bounds;
                HeatCell { x, y, value: value(cell), outlined: false }
            })
            .collect(),
        unit: format!("{velocity}²"),
        outline: String::new(),
    };
    let drawing = map.draw(&format!("{title} over position and velocity."))?;
    let header = ["position_from", "position_to", "velocity_from", "velocity_to", "acceleration", "samples"];
    let table = csv(&header, &result.surface, |cell: &SurfaceCell| {
        let [[left, right], [bottom, top]] = cell.bounds;
        let mut row = [left, right, bottom, top, value(cell)].map(number).to_vec();
        row.push(cell.samples.to_string());
        row
    });
    Some(framed(id, title.to_owned(), explanation.to_owned(), drawing, table))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_rise_in_amplitude_and_pass_over_what_has_no_value() {
        let points: Vec<BackbonePoint> = (0..200)
            .rev()
            .map(|index| BackbonePoint {
                amplitude: f64::from(index),
                frequency: 2.0 * f64::from(index),
                decay_rate: (index % 2 == 0).then_some(1.0),
            })
            .collect();
        let all = medians(&points, |point| Some(point.frequency));
        assert_eq!(all.len(), 40);
        assert!(all.windows(2).all(|pair| pair[0].0 < pair[1].0 && pair[0].1 < pair[1].1));
        assert_eq!(all[0], (2.0, 4.0));
        assert_eq!(medians(&points, |point| point.decay_rate).len(), 34);
    }
}
