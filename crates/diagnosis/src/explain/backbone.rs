//! Backbone curves and restoring-force surface of a system, computed from its series. They are plots for
//! people; no verdict rests on them.

#![allow(clippy::indexing_slicing, reason = "lobes and points are found among the samples that they index")]

use crate::answer::Series;
use dynamics::Coefficients;
use record::Quantity;
use std::f64::consts::PI;
use std::ops::Range;

/// One cycle of a free swing, from a turning point to the next but one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    /// Half the mean distance between neighboring turning points, in the unit of the values.
    pub amplitude: f64,
    /// Angular frequency in rad/s.
    pub frequency: f64,
    /// Rate at which the amplitude falls over the cycle, in 1/s.
    pub decay_rate: f64,
}

/// Cell of the restoring-force surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceCell {
    /// Lower and upper bound of the position, then of the velocity.
    pub bounds: [[f64; 2]; 2],
    /// Mean measured acceleration, without the input's part.
    pub measured: f64,
    /// Mean difference between this acceleration and that of the nominal law with the given coefficients.
    pub missing: f64,
    /// Number of samples in the cell.
    pub samples: usize,
}

/// Smallest lobe that counts, relative to the range of the stretch; noise makes smaller lobes of its own.
const SMALLEST_LOBE: f64 = 0.05;
/// Part of a lobe, on either side of its turning point, through which a parabola is laid. At its ends a
/// cosine departs from its parabola by 0.3 % of the amplitude.
const TURN: f64 = 1.0 / 6.0;
/// Number of cells of the surface along each axis.
const CELLS: usize = 14;
/// Minimum number of samples of a cell that is returned.
const FEWEST: usize = 5;
/// Part of a period, on either side of a sample, over which a cubic is fitted to get derivatives.
const REACH: f64 = 1.0 / 16.0;

/// Computes frequency and decay rate by amplitude, cycle by cycle. `values` has one value for each sample of
/// `series`, as `observed` does. Turning points are the vertices of parabolas through the neighborhood of
/// each extreme.
///
/// Segments have start states of their own, so that no cycle extends from one into the next.
#[must_use]
pub fn backbone(series: &Series, values: &[f64]) -> Vec<Swing> {
    let mut swings = Vec::new();
    for segment in segments(series) {
        let (Some(times), Some(values)) = (series.time_s.get(segment.clone()), values.get(segment)) else {
            continue;
        };
        let turns = turning_points(times, values);
        for three in turns.windows(3) {
            let &[first, middle, last] = three else { continue };
            let (before, after) = ((first.1 - middle.1).abs(), (middle.1 - last.1).abs());
            let cycle = last.0 - first.0;
            if cycle > 0.0 && before > 0.0 && after > 0.0 {
                swings.push(Swing {
                    amplitude: (before + after) / 4.0,
                    frequency: 2.0 * PI / cycle,
                    decay_rate: libm::log(before / after) / (cycle / 2.0),
                });
            }
        }
    }
    swings
}

/// Computes the measured acceleration as a function of position and velocity of the repaired motion.
///
/// Accelerations come from a local cubic through the observed values (which are of `quantity`), positions and
/// velocities from the repaired motion.
#[must_use]
pub fn surface(series: &Series, quantity: Quantity, coefficients: &Coefficients<f64>) -> Vec<SurfaceCell> {
    let (Some(across), Some(along)) = (extent(&series.position), extent(&series.velocity)) else {
        return Vec::new();
    };
    let period = period(series);
    let mut cells = vec![(0_usize, 0.0, 0.0); CELLS * CELLS];
    for segment in segments(series) {
        for index in segment.clone() {
            let Some(found) = acceleration(series, segment.clone(), index, quantity, REACH * period) else {
                continue;
            };
            let state = series.position.get(index).zip(series.velocity.get(index));
            let Some(((&x, &v), torque)) = state.zip(series.input_torque.get(index)) else { continue };
            let driven = found - torque / coefficients.inertia;
            let spring = coefficients.stiffness * (x - coefficients.rest_angle);
            let missing = driven + (coefficients.damping * v + spring) / coefficients.inertia;
            let place = |value: f64, [low, high]: [f64; 2]| {
                (((value - low) / (high - low) * CELLS as f64) as usize).min(CELLS - 1)
            };
            if let Some(cell) = cells.get_mut(place(x, across) * CELLS + place(v, along)) {
                *cell = (cell.0 + 1, cell.1 + driven, cell.2 + missing);
            }
        }
    }
    let edge = |[low, high]: [f64; 2], at: usize| {
        let step = (high - low) / CELLS as f64;
        [low + step * at as f64, low + step * (at + 1) as f64]
    };
    cells
        .into_iter()
        .enumerate()
        .filter(|(_, (samples, ..))| *samples >= FEWEST)
        .map(|(index, (samples, measured, missing))| SurfaceCell {
            bounds: [edge(across, index / CELLS), edge(along, index % CELLS)],
            measured: measured / samples as f64,
            missing: missing / samples as f64,
            samples,
        })
        .collect()
}

fn segments(series: &Series) -> impl Iterator<Item = Range<usize>> + '_ {
    let ends = series.segment_starts.iter().skip(1).copied().chain([series.time_s.len()]);
    series.segment_starts.iter().copied().zip(ends).map(|(start, end)| start..end)
}

fn extent(values: &[f64]) -> Option<[f64; 2]> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (low < high && (high - low).is_finite()).then_some([low, high])
}

/// Returns twice the mean time between reversals, in seconds; without any, the mean length of a segment.
fn period(series: &Series) -> f64 {
    let (mut length, mut reversals, mut count) = (0.0, 0.0, 0.0);
    for segment in segments(series) {
        if let Some([first, .., last]) = series.time_s.get(segment.clone()) {
            length += last - first;
            count += 1.0;
        }
        if let Some(speeds) = series.velocity.get(segment) {
            reversals += speeds.array_windows().filter(|[a, b]| a * b < 0.0).count() as f64;
        }
    }
    2.0 * length / f64::max(reversals, 2.0 * f64::max(count, 1.0))
}

/// Returns times and values of the turning points: those of complete lobes about the mean value of the
/// series.
fn turning_points(times: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    let Some([low, high]) = extent(values) else { return Vec::new() };
    let middle = values.iter().sum::<f64>() / values.len() as f64;
    let margin = SMALLEST_LOBE * (high - low);
    // Lobes end at a crossing with hysteresis, so that noise about the middle ends none.
    let mut lobes: Vec<Range<usize>> = Vec::new();
    let mut side = 0.0;
    let mut start = 0;
    for (index, value) in values.iter().enumerate() {
        let above = value - middle;
        if above.abs() > margin && above.signum() != side {
            if side != 0.0 {
                lobes.push(start..index);
            }
            side = above.signum();
            start = index;
        }
    }
    // The first lobe may have begun before the stretch did.
    lobes.into_iter().skip(1).filter_map(|lobe| turn(times, values, lobe, middle)).collect()
}

/// Returns the vertex of a parabola through the neighborhood of a lobe's extreme.
fn turn(times: &[f64], values: &[f64], lobe: Range<usize>, middle: f64) -> Option<(f64, f64)> {
    debug_assert!(times.len() == values.len() && lobe.end < values.len());
    let far = |index: usize| (values[index] - middle).abs();
    let top = lobe.clone().max_by(|&a, &b| far(a).total_cmp(&far(b)))?;
    let reach = TURN * (times[lobe.end] - times[lobe.start]);
    let center = times[top];
    let near = |index: &usize| (times[*index] - center).abs() <= reach;
    let points: Vec<(f64, f64)> =
        lobe.filter(near).map(|index| (times[index] - center, values[index])).collect();
    let [level, slope, bend, _] = cubic(&points, 2)?;
    let place = -slope / (2.0 * bend);
    (place.abs() <= reach).then(|| (center + place, level - slope * slope / (4.0 * bend)))
}

/// Returns the acceleration at a sample, from a local cubic through the observed values.
fn acceleration(
    series: &Series,
    segment: Range<usize>,
    index: usize,
    quantity: Quantity,
    reach: f64,
) -> Option<f64> {
    let at = |index: usize| Some((*series.time_s.get(index)?, *series.observed.get(index)?));
    let (now, value) = at(index)?;
    if quantity == Quantity::Acceleration {
        return Some(value);
    }
    let near = |index: usize| at(index).is_some_and(|(time, _)| (time - now).abs() <= reach);
    let within = |span: usize| index >= segment.start + span && index + span < segment.end;
    let span = (1..).take_while(|&span| within(span) && near(index - span) && near(index + span)).count();
    // A cubic needs two neighbors on either side; the ends of a segment lack them.
    let span = Some(span.max(2)).filter(|&span| within(span))?;
    let (first, last) = (index - span, index + span);
    let points: Vec<(f64, f64)> =
        (first..=last).filter_map(at).map(|(time, value)| (time - now, value)).collect();
    let [_, slope, bend, _] = cubic(&points, 3)?;
    Some(match quantity {
        Quantity::Velocity => slope,
        _ => 2.0 * bend,
    })
}

/// Fits a polynomial of a degree up to 3 to points about 0 by least squares; `None` if they do not determine
/// it.
fn cubic(points: &[(f64, f64)], degree: usize) -> Option<[f64; 4]> {
    let reach = points.iter().map(|point| point.0.abs()).fold(0.0, f64::max);
    if points.len() <= degree || reach == 0.0 {
        return None;
    }
    let values = nalgebra::DVector::from_iterator(points.len(), points.iter().map(|point| point.1));
    let power = |row: usize, power: usize| (points[row].0 / reach).powi(power as i32);
    let matrix = nalgebra::DMatrix::<f64>::from_fn(points.len(), degree + 1, power);
    let normal = matrix.tr_mul(&matrix).cholesky()?;
    let solved = normal.solve(&matrix.tr_mul(&values));
    let mut coefficients = [0.0; 4];
    for (power, coefficient) in coefficients.iter_mut().enumerate().take(degree + 1) {
        *coefficient = solved[power] / reach.powi(power as i32);
    }
    Some(coefficients)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A decaying cosine in stretches of six periods.
    fn decay(rate: f64, omega: f64) -> Series {
        let mut series = Series::default();
        for index in 0..5000 {
            let t = f64::from(index) / 260.0;
            if index % 500 == 0 {
                series.segment_starts.push(index as usize);
            }
            let shrink = 0.5 * (-rate * t).exp();
            series.time_s.push(t);
            series.observed.push(0.1 + shrink * (omega * t).cos());
            series.position.push(0.1 + shrink * (omega * t).cos());
            series.velocity.push(shrink * (-rate * (omega * t).cos() - omega * (omega * t).sin()));
            series.input_torque.push(0.0);
        }
        series
    }

    #[test]
    fn the_backbone_of_a_linear_decay_is_flat() {
        let series = decay(0.15, 22.0);
        let swings = backbone(&series, &series.observed);
        assert!(swings.len() > 80, "{}", swings.len());
        for swing in &swings {
            assert!((swing.frequency / 22.0 - 1.0).abs() < 2e-3, "{swing:?}");
            assert!((swing.decay_rate - 0.15).abs() < 0.02, "{swing:?}");
        }
        let mean = swings.iter().map(|swing| swing.decay_rate).sum::<f64>() / swings.len() as f64;
        assert!((mean - 0.15).abs() < 2e-3, "{mean}");
    }

    #[test]
    fn the_surface_of_a_linear_decay_lacks_nothing() {
        let (rate, omega) = (0.15, 22.0);
        let series = decay(rate, omega);
        let coefficients = Coefficients {
            inertia: 1.0,
            damping: 2.0 * rate,
            stiffness: omega * omega + rate * rate,
            rest_angle: 0.1,
            input_gain: 1.0,
        };
        let cells = surface(&series, Quantity::Position, &coefficients);
        assert!(cells.len() > 40, "{}", cells.len());
        let largest = cells.iter().map(|cell| cell.measured.abs()).fold(0.0, f64::max);
        assert!(largest > 150.0, "{largest}");
        for cell in &cells {
            assert!(cell.missing.abs() < 0.02 * largest, "{cell:?}");
        }
        let stiffer = Coefficients { stiffness: 500.0, ..coefficients };
        let missing = surface(&series, Quantity::Position, &stiffer);
        assert!(missing.iter().any(|cell| cell.missing.abs() > 3.0));
    }
}
