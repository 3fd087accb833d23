//! The pipeline we would recommend.

use crate::envelope::{Envelope, Extraction, FEWEST_PEAKS, differences, median};
use crate::error::EnvelopeError;
use crate::noise::noise_level;
use crate::peaks::{local_maxima, prominences};
use nalgebra::{DMatrix, DVector};
use record::{Clock, Record};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// The recommended pipeline: samples as taken, on a believed clock; both half-cycles; the position and
/// height of each turning point from a polynomial fitted to the samples around it; the rest position
/// from the turning points themselves; nothing below the sensor's noise.
///
/// The decay starts at the largest turning point: what lies before it is the release.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecommendedPipeline {
    /// Half-width of the polynomial's stretch around a turning point, in periods.
    pub half_width_periods: f64,
    /// Smallest amplitude used, in units of the noise (the larger of the sensor's noise and its
    /// quantum's 1/√12).
    pub floor_in_noise: f64,
}

impl Default for RecommendedPipeline {
    /// What a configuration has that says nothing.
    fn default() -> Self {
        Self { half_width_periods: 1.0 / 6.0, floor_in_noise: 8.0 }
    }
}

/// Most iterations of a singular value decomposition with at most five columns; some ten are usual.
const MOST_SWEEPS: usize = 1000;

/// A turning point.
#[derive(Debug, Clone, Copy)]
struct Turn {
    time: f64,
    value: f64,
}

impl RecommendedPipeline {
    /// Extracts the envelope of a record under a clock.
    ///
    /// # Errors
    /// [`EnvelopeError::TooFewPeaks`] for fewer than three turning points above the noise.
    pub fn extract(&self, record: &Record, clock: &Clock) -> Result<Extraction, EnvelopeError> {
        let values = record.values();
        let quantum = record.lattice().map_or(0.0, |lattice| lattice.step);
        let noise = noise_level(values).max(quantum / 12_f64.sqrt());
        let floor = self.floor_in_noise * noise;

        // Prominence is from valley to top: twice the amplitude.
        let upper = prominent(values.to_vec(), 2.0 * floor);
        let lower = prominent(values.iter().map(|value| -value).collect(), 2.0 * floor);
        let too_few = |found: usize| EnvelopeError::TooFewPeaks {
            pipeline: "recommended",
            found,
            needed: FEWEST_PEAKS,
            remedy: format!(
                "Turning points must stand {floor:.2e} {} above a noise of {noise:.2e}; lower \
                 envelope.recommended.floor_in_noise, or give a longer record. A motion \
                 that stops within a few swings has no envelope.",
                record.unit()
            ),
        };
        let coarse_times = |peaks: &[usize]| -> Vec<f64> {
            peaks.iter().filter_map(|&peak| clock.times_s.get(peak).copied()).collect()
        };
        let periods =
            [&upper, &lower].into_iter().flat_map(|peaks| differences(&coarse_times(peaks), 1)).collect();
        let coarse_period = median(periods).ok_or_else(|| too_few(upper.len() + lower.len()))?;

        let half_width = self.half_width_periods * coarse_period;
        let mut indices = [upper, lower].concat();
        indices.sort_unstable();
        let turns: Vec<Turn> =
            indices.iter().filter_map(|&at| refine(&clock.times_s, values, at, half_width)).collect();

        let offset = center(&turns).ok_or_else(|| too_few(turns.len()))?;
        let decay = free_decay(&turns, offset, floor);
        if decay.len() < FEWEST_PEAKS {
            return Err(too_few(decay.len()));
        }
        let times: Vec<f64> = decay.iter().map(|turn| turn.time).collect();
        let log_amplitudes = decay.iter().map(|turn| (turn.value - offset).abs().ln()).collect();
        // Turning points on the same side are two apart.
        let period_s = median(differences(&times, 2)).unwrap_or(coarse_period);
        let start = clock.times_s.first().copied().unwrap_or_default();
        Ok(Extraction {
            first_peak_s: times.first().copied().unwrap_or_default() - start,
            envelope: Envelope::new(times, log_amplitudes, TAU / period_s)?,
            period_s,
            offset,
            samples: values.len(),
        })
    }
}

fn prominent(values: Vec<f64>, least: f64) -> Vec<usize> {
    let maxima = local_maxima(&values);
    let prominences = prominences(&values, &maxima);
    maxima
        .into_iter()
        .zip(prominences)
        .filter(|(_, prominence)| *prominence >= least && *prominence > 0.0)
        .map(|(peak, _)| peak)
        .collect()
}

/// Time and value of the turning point near a sample: the stationary point of a polynomial fitted to
/// the samples within `half_width` of it. Quartic where there are samples enough, so that the shape of
/// a swing does not pull the height; else a parabola. `None` where even that has no samples, or where
/// the stationary point falls outside the stretch.
fn refine(times: &[f64], values: &[f64], at: usize, half_width: f64) -> Option<Turn> {
    let center = *times.get(at)?;
    let from = times.partition_point(|&time| time < center - half_width);
    let to = times.partition_point(|&time| time <= center + half_width);
    // A coarse record may have no neighbors inside the stretch: take the nearest ones then.
    let (from, to) = (from.min(at.saturating_sub(1)), to.max(at + 2).min(times.len()));
    let (times, values) = (times.get(from..to)?, values.get(from..to)?);
    let order = match values.len() {
        0..=2 => return None,
        3..=8 => 2,
        _ => 4,
    };
    let scale = times.iter().map(|time| (time - center).abs()).fold(0.0, f64::max);
    // A burst on the host's clock: no time passes, so there is nothing to fit over.
    if scale <= 0.0 {
        return None;
    }
    let design = DMatrix::from_fn(values.len(), order + 1, |row, power| {
        times.get(row).map_or(0.0, |time| ((time - center) / scale).powi(power as i32))
    });
    // Without a limit the decomposition of what is not finite never ends.
    let decomposition = design.try_svd(true, true, 5.0 * f64::EPSILON, MOST_SWEEPS)?;
    let solution = decomposition.solve(&DVector::from_row_slice(values), 1e-12).ok()?;
    let coefficients: Vec<f64> = solution.iter().copied().collect();
    // Newton's method on the derivative, from the sample; it needs few steps on a smooth top.
    let mut u = 0.0;
    for _ in 0..20 {
        let (_, slope, curvature) = evaluate(&coefficients, u);
        let step = slope / curvature;
        if !step.is_finite() {
            return None;
        }
        u -= step;
        if step.abs() < 1e-13 {
            break;
        }
    }
    (u.abs() <= 1.0).then(|| Turn { time: center + u * scale, value: evaluate(&coefficients, u).0 })
}

/// Value, first and second derivative of a polynomial with rising powers.
fn evaluate(coefficients: &[f64], u: f64) -> (f64, f64, f64) {
    coefficients.iter().rev().fold((0.0, 0.0, 0.0), |(value, slope, curvature), coefficient| {
        (value * u + coefficient, slope * u + value, curvature * u + 2.0 * slope)
    })
}

/// The position that successive turning points swing about: the median of their weighted means
/// (1, 2, 1)/4, from which a geometric decay drops out to second order.
fn center(turns: &[Turn]) -> Option<f64> {
    median(
        turns
            .windows(3)
            .filter_map(|part| match part {
                [a, b, c] => Some(0.25 * (a.value + 2.0 * b.value + c.value)),
                _ => None,
            })
            .collect(),
    )
}

/// The turning points from the largest one on, up to the first that is not above the floor or does not
/// lie on the other side of the center.
fn free_decay(turns: &[Turn], center: f64, floor: f64) -> Vec<Turn> {
    let size = |turn: &Turn| (turn.value - center).abs();
    let largest = turns
        .iter()
        .enumerate()
        .max_by(|(_, a), (_, b)| size(a).total_cmp(&size(b)))
        .map_or(0, |(index, _)| index);
    let mut side: Option<bool> = None;
    turns
        .iter()
        .skip(largest)
        .take_while(|turn| {
            let above = turn.value > center;
            let alternates = side != Some(above);
            side = Some(above);
            alternates && size(turn) > floor
        })
        .copied()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::refine;

    /// Found by fuzzing: samples around a turning point that share one stamp were fitted over no time at all.
    #[test]
    fn a_burst_on_one_stamp_has_no_turning_point_and_an_end() {
        let times = [0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0];
        let values = [0.0, 1.0, 2.0, 3.0, 2.0, 1.0, 0.0];
        assert!(refine(&times, &values, 3, 0.1).is_none());
        assert!(refine(&times, &values, 3, 1.0).is_some());
    }
}
