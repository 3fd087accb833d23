//! Lines in the spectrum of a residual.

use crate::segments::Data;

/// A line and its score.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    /// Angular frequency in rad/s.
    pub(crate) frequency: f64,
    /// Squares of the residual that a sine and a cosine of this frequency take away.
    pub(crate) gain: f64,
}

/// Frequencies looked at, at most.
const MOST_FREQUENCIES: usize = 4000;

/// The highest angular frequency looked at. A search looks at every so many samples only.
fn highest(data: &Data) -> f64 {
    let steps = data.segments.iter().map(|segment| segment.times.len().saturating_sub(1)).sum::<usize>();
    let spans =
        data.segments.iter().filter_map(|segment| Some(segment.times.last()? - segment.times.first()?));
    data.facts.highest_frequency(spans.sum::<f64>() / steps.max(1) as f64)
}

/// About how many independent frequencies the lines of a whole record are chosen from.
pub(crate) fn frequencies(data: &Data) -> f64 {
    (highest(data) * data.facts.duration / std::f64::consts::TAU).max(1.0)
}

/// Adds to each frequency of a grid what a sine and a cosine of it take away from values at even or uneven times.
///
/// The phasor of each sample is turned from one frequency to the next, which costs four products in place of a sine
/// and a cosine.
fn add(points: &[(f64, f64)], lowest: f64, step: f64, gains: &mut [f64]) {
    let turned = |frequency: f64| points.iter().map(move |(time, _)| (frequency * time).sin_cos());
    let mut phasors: Vec<(f64, f64)> = turned(lowest).collect();
    let turns: Vec<(f64, f64)> = turned(step).collect();
    let scale = 2.0 / points.len().max(1) as f64;
    for gain in gains {
        let (mut sine, mut cosine) = (0.0, 0.0);
        for (((s, c), (ds, dc)), (_, value)) in phasors.iter_mut().zip(&turns).zip(points) {
            sine += value * *s;
            cosine += value * *c;
            (*s, *c) = (*s * dc + *c * ds, *c * dc - *s * ds);
        }
        *gain += scale * (sine * sine + cosine * cosine);
    }
}

/// The strongest lines of a residual that comes in segments. `coherent`: one phase for a record, as of a machine
/// next door; otherwise each segment has its own, as of a second mode struck anew.
///
/// Peaks of the periodogram on a grid of half the resolution.
pub(crate) fn lines(data: &Data, residuals: &[&[f64]], coherent: bool, most: usize) -> Vec<Line> {
    let span = if coherent { data.facts.duration } else { data.longest_span() };
    let highest = highest(data);
    let lowest = 1.5 * std::f64::consts::TAU / span;
    let count = (((highest - lowest) * span / std::f64::consts::PI) as usize).clamp(1, MOST_FREQUENCIES);
    let records = data.inputs.len();
    let step = (highest - lowest) / count as f64;
    let mut gains = vec![0.0; count];
    if coherent {
        for record in 0..records {
            let own = data.segments.iter().zip(residuals).filter(|(segment, _)| segment.record == record);
            let points: Vec<(f64, f64)> =
                own.flat_map(|(segment, e)| segment.times.iter().copied().zip(e.iter().copied())).collect();
            add(&points, lowest, step, &mut gains);
        }
    } else {
        for (segment, residual) in data.segments.iter().zip(residuals) {
            let points: Vec<(f64, f64)> =
                segment.times.iter().copied().zip(residual.iter().copied()).collect();
            add(&points, lowest, step, &mut gains);
        }
    }
    let powers: Vec<Line> = gains
        .into_iter()
        .enumerate()
        .map(|(at, gain)| Line { frequency: lowest + step * at as f64, gain })
        .collect();
    let at = |index: Option<usize>| index.and_then(|i| powers.get(i)).map_or(0.0, |line| line.gain);
    let mut peaks: Vec<Line> = powers
        .iter()
        .enumerate()
        .filter(|(i, line)| line.gain > at(i.checked_sub(1)) && line.gain >= at(Some(i + 1)))
        .map(|(_, line)| *line)
        .collect();
    peaks.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    peaks.truncate(most);
    peaks
}
