//! Envelope pipeline of the paper.

use crate::envelope::{Envelope, Extraction, FEWEST_PEAKS, differences};
use crate::error::EnvelopeError;
use crate::interpolation::resample;
use crate::peaks::find_peaks;
use crate::savitzky_golay::savitzky_golay;
use crate::stretches::stretches;
use record::{Clock, Record, median};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Most points of the interpolation grid.
const MOST_POINTS: usize = 50_000_000;

/// Pipeline of the paper: linear interpolation to an even step, smoothing, removal of the late-time mean,
/// peaks with a least distance and prominence, upper half-cycles only.
///
/// With the defaults and the host's clock it gives the numbers of the paper's Table 3 on the paper's record.
/// Interpolation on repeated time stamps puts the jumps of the host's bursts into the values. The paper did
/// so, and this is one reason why [`crate::RecommendedPipeline`] gives other numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PaperPipeline {
    /// Step of the interpolation grid, in seconds.
    pub interpolation_step_s: f64,
    /// Window of the Savitzky–Golay smoothing, in grid points; 0 for no smoothing.
    pub smoothing_window: usize,
    /// Order of the smoothing polynomial.
    pub smoothing_order: usize,
    /// Share of the grid points at the end whose mean is the rest position.
    pub late_fraction: f64,
    /// Least distance between peaks, in grid points.
    pub peak_distance: usize,
    /// Least prominence of a peak, in the record's unit.
    pub prominence: f64,
}

impl PaperPipeline {
    /// Extracts the envelope of a record under a clock.
    ///
    /// # Errors
    /// [`EnvelopeError`] for fewer than three peaks, a peak at or below the rest position, or a grid or a
    /// smoothing window that does not fit.
    pub fn extract(&self, record: &Record, clock: &Clock) -> Result<Extraction, EnvelopeError> {
        let step = self.interpolation_step_s;
        let pieces = self.smooth(record, clock)?;

        // At least one point, at most all of them. For some lengths the product lies a rounding error above a
        // whole number, which must not add a point.
        let points: usize = pieces.iter().map(|piece| piece.values.len()).sum();
        let late = (points as f64 * self.late_fraction - 1e-9).ceil() as usize;
        let late = late.clamp(1, points.max(1));
        let all = pieces.iter().flat_map(|piece| piece.values.iter().copied());
        let offset = all.skip(points.saturating_sub(late)).sum::<f64>() / late as f64;

        let peaks = self.peaks(pieces, offset);
        if peaks.len() < FEWEST_PEAKS {
            return Err(self.too_few(peaks.len(), record.unit()));
        }
        let peak_times: Vec<f64> = peaks.iter().map(|(point, _)| *point as f64 * step).collect();
        let mut log_amplitudes = Vec::with_capacity(peaks.len());
        for ((number, &(_, amplitude)), &time_s) in peaks.iter().enumerate().zip(&peak_times) {
            if amplitude <= 0.0 {
                return Err(EnvelopeError::AmplitudeNotPositive {
                    number: number + 1,
                    time_s,
                    amplitude,
                    unit: record.unit(),
                });
            }
            log_amplitudes.push(libm::log(amplitude));
        }
        let (Some(period_s), Some(&first_peak_s)) = (median(differences(&peak_times, 1)), peak_times.first())
        else {
            return Err(self.too_few(peaks.len(), record.unit()));
        };
        Ok(Extraction {
            pipeline: "paper",
            because: None,
            envelope: Envelope::new(peak_times, log_amplitudes, TAU / period_s)?,
            first_peak_s,
            period_s,
            offset,
            samples: points,
        })
    }

    /// Returns the grid indices of the peaks with their heights above the rest position.
    fn peaks(&self, pieces: Vec<Piece>, offset: f64) -> Vec<(usize, f64)> {
        let of_piece = |piece: Piece| {
            let values: Vec<f64> = piece.values.iter().map(|value| value - offset).collect();
            let found = find_peaks(&values, self.peak_distance, self.prominence);
            found.into_iter().filter_map(move |at| Some((piece.first + at, *values.get(at)?)))
        };
        pieces.into_iter().flat_map(of_piece).collect()
    }

    fn too_few(&self, found: usize, unit: &str) -> EnvelopeError {
        EnvelopeError::TooFewPeaks {
            pipeline: "paper",
            found,
            needed: FEWEST_PEAKS,
            remedy: format!(
                "Peaks are at least {} points of {} s apart and {} {unit} prominent; lower \
                 envelope.paper.peak_distance or envelope.paper.prominence, or give a longer record. A motion that \
                 stops within a few swings has no envelope.",
                self.peak_distance, self.interpolation_step_s, self.prominence
            ),
        }
    }

    /// Returns the smoothed record on an even grid that starts at its first sample. If the record has rows
    /// without a value, it is cut at steps in time that are longer than three usual steps and longer than
    /// half the least distance of peaks.
    fn smooth(&self, record: &Record, clock: &Clock) -> Result<Vec<Piece>, EnvelopeError> {
        let first = clock.start_s();
        let times: Vec<f64> = clock.times_s.iter().map(|time| time - first).collect();
        let step = self.interpolation_step_s;
        let duration = clock.duration_s();
        if duration / step > MOST_POINTS as f64 {
            return Err(EnvelopeError::GridTooFine {
                duration_s: duration,
                step_s: step,
                points: duration / step,
                most: MOST_POINTS,
            });
        }
        let grid = resample(&times, record.values(), step);
        let parts = match record.empty_rows() {
            0 => Vec::new(),
            _ => stretches(&times, 0.5 * self.peak_distance as f64 * step),
        };
        let smoothed = |values: &[f64]| savitzky_golay(values, self.smoothing_window, self.smoothing_order);
        if parts.len() < 2 {
            return Ok(vec![Piece { first: 0, values: smoothed(&grid)? }]);
        }
        let mut pieces = Vec::new();
        for part in parts {
            let Some((first, last)) = times.get(part).and_then(|own| own.first().zip(own.last())) else {
                continue;
            };
            let (from, to) = ((first / step).ceil() as usize, (last / step).floor() as usize + 1);
            let Some(values) = grid.get(from..to.min(grid.len())) else { continue };
            // A piece shorter than a window cannot be smoothed and is left out.
            if values.len() >= self.smoothing_window.max(1) {
                pieces.push(Piece { first: from, values: smoothed(values)? });
            }
        }
        Ok(pieces)
    }
}

/// Grid points without a gap between them.
struct Piece {
    /// Index of the first one among all grid points.
    first: usize,
    values: Vec<f64>,
}
