//! Plots of what free runs miss: over time and over frequency.

use super::runs::{Drawn, named};
use crate::figures::{Figure, csv, figure, number};
use crate::plot::{Axis, Hue, Mark, Plot, Series};
use results::{LearnProblem, LearnSeriesRow};
use std::f64::consts::TAU;

/// Most samples of a segment of a spectrum, and the fewest.
const MOST_SAMPLES: usize = 256;
const FEWEST_SAMPLES: usize = 32;

/// Returns the plots of record less prediction for the drawn methods.
pub(super) fn figures(id: &str, problem: &LearnProblem, drawn: &[Drawn<'_>]) -> Vec<Figure> {
    let missed: Vec<(&str, Vec<(f64, f64)>)> =
        drawn.iter().map(|(row, runs)| (row.title.as_str(), missed(runs))).collect();
    let spectra: Vec<(&str, Vec<(f64, f64)>)> =
        missed.iter().map(|(title, points)| (*title, spectrum(points))).collect();
    let record = drawn.iter().find_map(|(_, runs)| Some(runs.first()?.record.as_str())).unwrap_or_default();
    let over_time = plotted(
        (format!("{id}-residual"), format!("What the free runs miss: {}", named(problem))),
        &format!(
            "Record less prediction over the test record {record}. An error that grows shows drift or an instability; one \
                  that follows the motion shows a law that is wrong."
        ),
        ("time (s)", Axis::linear(format!("record less prediction ({})", problem.unit))),
        &missed,
    );
    let over_frequency = plotted(
        (
            format!("{id}-residual-spectrum"),
            format!("What the free runs miss, by frequency: {}", named(problem)),
        ),
        &format!(
            "Amplitude density of record less prediction over {record}: the mean of the spectra of half-overlapping \
                  segments with a Hann window. A peak at a resonance shows a wrong law or input, one at its multiples a \
                  wrong nonlinearity; an even line is the noise of the sensor."
        ),
        ("frequency (Hz)", Axis::log(format!("amplitude density ({}/√Hz)", problem.unit))),
        &spectra,
    );
    over_time.into_iter().chain(over_frequency).collect()
}

fn plotted(
    (id, title): (String, String),
    explanation: &str,
    (x, y): (&str, Axis),
    curves: &[(&str, Vec<(f64, f64)>)],
) -> Option<Figure> {
    let series = curves.iter().enumerate().map(|(index, (title, points))| Series {
        label: (*title).to_owned(),
        hue: Hue::of_series(index),
        mark: if index.is_multiple_of(2) { Mark::Line } else { Mark::Dashes },
        points: points.clone(),
    });
    let plot = Plot { x: Axis::linear(x), y, series: series.collect(), shaded: vec![] };
    let rows: Vec<(&str, f64, f64)> =
        curves.iter().flat_map(|(title, points)| points.iter().map(|(x, y)| (*title, *x, *y))).collect();
    let table = csv(&["method", x, "residual"], &rows, |(title, x, y)| {
        vec![(*title).to_owned(), number(*x), number(*y)]
    });
    figure(id, title, explanation, &plot, table)
}

/// Returns times and record less prediction.
fn missed(runs: &[&LearnSeriesRow]) -> Vec<(f64, f64)> {
    runs.iter().map(|row| (row.time_s, row.observed - row.predicted)).collect()
}

/// Returns frequencies in Hz and amplitude densities of even samples, from the mean of the spectra of segments that
/// overlap by half (Welch, IEEE Transactions on Audio and Electroacoustics 15 (1967) 70); empty for few samples.
fn spectrum(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let length = MOST_SAMPLES.min(points.len() / 4);
    let (Some((start, _)), Some((end, _))) = (points.first(), points.last()) else { return Vec::new() };
    if length < FEWEST_SAMPLES {
        return Vec::new();
    }
    let rate_hz = (points.len() - 1) as f64 / (end - start);
    let window: Vec<f64> =
        (0..length).map(|at| 0.5 - 0.5 * (TAU * (at as f64 + 0.5) / length as f64).cos()).collect();
    let size: f64 = window.iter().map(|own| own * own).sum();
    let segments = || points.windows(length).step_by(length / 2);
    let count = segments().count() as f64;
    let line = |number: usize| {
        let turn = TAU * number as f64 / length as f64;
        let power: f64 = segments()
            .map(|segment| {
                let (mut cosine, mut sine) = (0.0, 0.0);
                for (at, ((_, value), weight)) in segment.iter().zip(&window).enumerate() {
                    let (s, c) = (turn * at as f64).sin_cos();
                    (cosine, sine) = (cosine + weight * value * c, sine + weight * value * s);
                }
                cosine * cosine + sine * sine
            })
            .sum();
        // Both halves of the spectrum together.
        (number as f64 * rate_hz / length as f64, (2.0 * power / (count * size * rate_hz)).sqrt())
    };
    (1..length / 2).map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::spectrum;
    use std::f64::consts::TAU;

    /// The squares of the densities, summed over the frequencies, are the mean square of the samples.
    #[test]
    fn a_sine_has_its_power_at_its_frequency() {
        let points: Vec<(f64, f64)> = (0..2000)
            .map(|at| f64::from(at) * 0.01)
            .map(|time| (time, 3.0 * (TAU * 12.5 * time).sin()))
            .collect();
        let lines = spectrum(&points);
        let step = lines[1].0 - lines[0].0;
        let power: f64 = lines.iter().map(|(_, density)| density * density * step).sum();
        assert!((power / 4.5 - 1.0).abs() < 0.01, "{power}");
        let peak = lines.iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert!((peak.0 - 12.5).abs() < step, "{peak:?}");
        assert!(spectrum(&points[..40]).is_empty());
    }
}
