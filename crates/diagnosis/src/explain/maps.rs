//! Maps of the gap over time, amplitude, phase plane and frequency.

use crate::data::segments::Data;
use crate::linear::tangent::Path;
use crate::noise::statistics::chi_squared_above;
use nalgebra::DVector;
use results::MapCell;

/// Probability that noise alone lifts any cell of a map above its band.
const FAMILY: f64 = 0.05;

const AMPLITUDES: usize = 8;
const PLANE: usize = 6;
/// Edges of the frequency bands, in multiples of the oscillator's own frequency.
const BANDS: [f64; 8] = [0.0, 0.5, 1.5, 2.5, 3.5, 5.0, 8.0, 12.0];
const FEWEST: usize = 10;

/// One sample of a map: its coordinates and both residuals.
struct Sample {
    at: Vec<f64>,
    recalibrated: f64,
    repaired: f64,
}

/// Computes the cells of a regular grid. The band of a cell is the noise times the square root of the upper
/// quantile of χ²/n, at a probability shared among the cells (Bonferroni).
fn cells(samples: &[Sample], edges: &[Vec<f64>], noise: f64) -> Vec<MapCell> {
    let mut bounds: Vec<Vec<[f64; 2]>> = vec![Vec::new()];
    for axis in edges {
        bounds = bounds
            .iter()
            .flat_map(|before| {
                axis.windows(2).filter_map(move |pair| match pair {
                    &[low, high] => Some(before.iter().copied().chain([[low, high]]).collect()),
                    _ => None,
                })
            })
            .collect();
    }
    let filled: Vec<(Vec<[f64; 2]>, Vec<&Sample>)> = bounds
        .into_iter()
        .map(|bounds| {
            let inside = samples
                .iter()
                .filter(|sample| sample.at.iter().zip(&bounds).all(|(x, [low, high])| x >= low && x < high));
            let inside: Vec<&Sample> = inside.collect();
            (bounds, inside)
        })
        .filter(|(_, inside)| inside.len() >= FEWEST)
        .collect();
    let each = FAMILY / filled.len().max(1) as f64;
    filled
        .into_iter()
        .map(|(bounds, inside)| {
            let count = inside.len() as f64;
            let rms = |of: &dyn Fn(&Sample) -> f64| {
                (inside.iter().map(|sample| of(sample).powi(2)).sum::<f64>() / count).sqrt()
            };
            let value = rms(&|sample| sample.recalibrated);
            let band = noise * (chi_squared_above(count, each) / count).sqrt();
            MapCell {
                bounds,
                value,
                repaired: rms(&|sample| sample.repaired),
                band,
                significant: value > band,
                samples: inside.len(),
            }
        })
        .collect()
}

fn even(low: f64, high: f64, count: usize) -> Vec<f64> {
    // The last edge lies slightly beyond the highest value, so that this value is inside.
    let width = (high - low) * (1.0 + 1e-9);
    (0..=count).map(|i| low + width * i as f64 / count as f64).collect()
}

/// Computes all four maps: over time, amplitude, phase plane and frequency.
pub(crate) fn maps(
    data: &Data,
    paths: &[Path],
    rest: f64,
    recalibrated: &[DVector<f64>],
    repaired: &[DVector<f64>],
    noise: f64,
) -> [Vec<MapCell>; 4] {
    let omega = data.facts.frequency;
    // A rest position that the records hardly determine may lie far outside them.
    let range = [data.facts.lowest, data.facts.highest];
    let rest = if (range[0]..=range[1]).contains(&rest) { rest } else { 0.5 * (range[0] + range[1]) };
    let (mut time, mut amplitude, mut phase) = (Vec::new(), Vec::new(), Vec::new());
    for ((path, before), after) in paths.iter().zip(recalibrated).zip(repaired) {
        let motion = path.motion.position.iter().zip(&path.motion.velocity).zip(&path.times);
        for (((x, v), t), (before, after)) in motion.zip(before.iter().zip(after.iter())) {
            let add = |map: &mut Vec<Sample>, at: Vec<f64>| {
                map.push(Sample { at, recalibrated: *before, repaired: *after });
            };
            add(&mut time, vec![*t]);
            add(&mut amplitude, vec![libm::hypot(x - rest, v / omega)]);
            add(&mut phase, vec![*x, *v]);
        }
    }
    let most = |map: &[Sample]| {
        map.iter().filter_map(|sample| sample.at.first()).fold(0.0, |most: f64, x| most.max(*x))
    };
    let speed = phase.iter().filter_map(|s: &Sample| s.at.get(1)).fold(0.0, |most: f64, v| most.max(v.abs()));
    let segments = data.segments.len().clamp(2, 40);
    [
        cells(&time, &[even(0.0, most(&time), segments)], noise),
        cells(&amplitude, &[even(0.0, most(&amplitude), AMPLITUDES)], noise),
        cells(&phase, &[even(range[0], range[1], PLANE), even(-speed, speed, PLANE)], noise),
        spectrum(data, recalibrated, repaired, noise),
    ]
}

/// Computes the RMS of a residual in bands of frequency, from the periodogram of each segment.
fn spectrum(
    data: &Data,
    recalibrated: &[DVector<f64>],
    repaired: &[DVector<f64>],
    noise: f64,
) -> Vec<MapCell> {
    let omega = data.facts.frequency;
    let highest = std::f64::consts::PI / data.interval();
    let edges: Vec<f64> = BANDS.iter().map(|band| (band * omega).min(highest)).collect();
    let bands: Vec<[f64; 2]> =
        edges.iter().zip(edges.iter().skip(1)).filter(|(a, b)| b > a).map(|(a, b)| [*a, *b]).collect();
    let each = FAMILY / bands.len().max(1) as f64;
    let total: usize = data.segments.iter().map(|segment| segment.times.len()).sum();
    bands
        .into_iter()
        .filter_map(|[low, high]| {
            let (mut before, mut after, mut lines) = (0.0, 0.0, 0_usize);
            for ((segment, one), two) in data.segments.iter().zip(recalibrated).zip(repaired) {
                let (Some(first), Some(last)) = (segment.times.first(), segment.times.last()) else {
                    continue;
                };
                let step = std::f64::consts::TAU / (last - first);
                let from = (low / step).floor() as usize + 1;
                let to = (high / step).floor() as usize;
                for line in from..=to {
                    let frequency = step * line as f64;
                    let square = |e: &DVector<f64>| {
                        let (mut sine, mut cosine) = (0.0, 0.0);
                        for (time, value) in segment.times.iter().zip(e.iter()) {
                            let (s, c) = libm::sincos(frequency * (time - first));
                            sine += s * value;
                            cosine += c * value;
                        }
                        2.0 * (sine * sine + cosine * cosine) / e.len().max(1) as f64
                    };
                    before += square(one);
                    after += square(two);
                    lines += 1;
                }
            }
            // A line holds two degrees of freedom of the noise.
            let degrees = 2.0 * lines as f64;
            let rms = |squares: f64| (squares / total.max(1) as f64).sqrt();
            let band = rms(noise * noise * chi_squared_above(degrees, each));
            (lines > 0).then(|| MapCell {
                bounds: vec![[low, high]],
                value: rms(before),
                repaired: rms(after),
                band,
                significant: rms(before) > band,
                samples: total,
            })
        })
        .collect()
}
