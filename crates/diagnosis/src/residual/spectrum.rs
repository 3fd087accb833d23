//! Lines in the spectrum of a residual, steady and decaying.

use crate::data::segments::Data;
use crate::noise::periodogram::{Line, MOST_FREQUENCIES, add, peaks};

/// Returns the highest angular frequency examined. It follows from the sampling interval of these data, which
/// is longer in a search.
fn highest(data: &Data) -> f64 {
    data.facts.highest_frequency(data.interval())
}

/// Returns the approximate number of independent frequencies from which the lines of a whole record are
/// chosen.
pub(crate) fn frequencies(data: &Data) -> f64 {
    (highest(data) * data.facts.duration / std::f64::consts::TAU).max(1.0)
}

/// Returns a grid of angular frequencies from 1.5 periods per span up, at half the span's resolution: the
/// lowest, the step, and their number.
fn grid(data: &Data, span: f64) -> (f64, f64, usize) {
    let highest = highest(data);
    let lowest = 1.5 * std::f64::consts::TAU / span;
    let count = (((highest - lowest) * span / std::f64::consts::PI) as usize).clamp(1, MOST_FREQUENCIES);
    (lowest, (highest - lowest) / count as f64, count)
}

/// Gains of steady lines on a grid of angular frequencies, in rad/s.
pub(crate) struct Spectrum {
    pub(crate) lowest: f64,
    pub(crate) step: f64,
    /// Decrease of the sum of squares by a sine and a cosine of each frequency.
    pub(crate) gains: Vec<f64>,
}

/// Returns the spectrum of a residual that comes in segments. Each line has one phase per record, like the
/// vibration of a nearby machine.
pub(crate) fn steady(data: &Data, residuals: &[&[f64]]) -> Spectrum {
    let (lowest, step, count) = grid(data, data.facts.duration);
    let mut gains = vec![0.0; count];
    for record in 0..data.inputs.len() {
        let own = data.segments.iter().zip(residuals).filter(|(segment, _)| segment.record == record);
        let points: Vec<(f64, f64)> =
            own.flat_map(|(segment, e)| segment.times.iter().copied().zip(e.iter().copied())).collect();
        add(&points, points.len() as f64, lowest, step, &mut gains);
    }
    Spectrum { lowest, step, gains }
}

/// Returns the strongest steady lines of a residual that comes in segments: peaks of its spectrum.
pub(crate) fn lines(data: &Data, residuals: &[&[f64]], most: usize) -> Vec<Line> {
    let Spectrum { lowest, step, gains } = steady(data, residuals);
    peaks(&gains, lowest, step, most)
}

/// Decay over the longest segment, as a logarithm, at which a second mode is searched for.
pub(crate) const DECAYS: [f64; 4] = [1.0, 4.0, 16.0, 64.0];

/// Returns the strongest lines that decay from the beginning of each segment, each with a phase of its own
/// there, like a second mode that is struck anew, with their decay rates in 1/s.
///
/// A steady sine explains only the share 2/(r·T) of the squares of a line that decays at a rate r over a span
/// T. So each rate is tried separately, with sine and cosine under exp(−r·t).
pub(crate) fn decaying_lines(data: &Data, residuals: &[&[f64]], most: usize) -> Vec<(Line, f64)> {
    let span = data.longest_span();
    let (lowest, step, count) = grid(data, span);
    let mut found: Vec<(Line, f64)> = Vec::new();
    for decay in DECAYS {
        let rate = decay / span;
        let mut gains = vec![0.0; count];
        for (segment, residual) in data.segments.iter().zip(residuals) {
            let start = segment.start_s();
            let mut squares = 0.0;
            let pairs = segment.times.iter().zip(*residual);
            let points: Vec<(f64, f64)> = pairs
                .map(|(time, value)| {
                    let weight = libm::exp(-rate * (time - start));
                    squares += weight * weight;
                    (*time, weight * value)
                })
                .collect();
            add(&points, squares, lowest, step, &mut gains);
        }
        found.extend(peaks(&gains, lowest, step, most).into_iter().map(|line| (line, rate)));
    }
    found.sort_by(|a, b| b.0.gain.total_cmp(&a.0.gain));
    // One line, searched for at several rates, is found once for each of them.
    let width = |one: f64, other: f64| 2.0 * one.max(other) + 4.0 * step;
    let apart = |(one, own): &(Line, f64), (other, its): &(Line, f64)| {
        (one.frequency - other.frequency).abs() > width(*own, *its)
    };
    that_lie_apart(found, apart, most)
}

/// Returns the first `most` elements of a list, best first, that all lie apart: of several close ones the
/// best is kept.
pub(crate) fn that_lie_apart<T>(found: Vec<T>, apart: impl Fn(&T, &T) -> bool, most: usize) -> Vec<T> {
    let mut chosen: Vec<T> = Vec::new();
    for one in found {
        if chosen.len() < most && chosen.iter().all(|other| apart(&one, other)) {
            chosen.push(one);
        }
    }
    chosen
}
