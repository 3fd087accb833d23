//! Spectrum of a record, with its modes.

use results::{DiagnosisResult, ModeRow, SeriesRow};
use std::f64::consts::TAU;

use super::figures::{framed, observed_axis};
use crate::figures::{Figure, csv, number};
use crate::modes::sentence;
use crate::plot::{Axis, Hue, Mark, Plot, Series};

/// Most samples and most frequencies of a spectrum.
const MOST_SAMPLES: usize = 8192;
const MOST_LINES: usize = 600;
/// Highest frequency shown, in frequencies of the strongest line.
const HARMONICS: f64 = 5.0;

/// Returns the amplitude spectrum of the first record.
pub(super) fn figure(result: &DiagnosisResult, rows: &[SeriesRow]) -> Option<Figure> {
    let first = rows.chunk_by(|one, next| one.record == next.record).next()?;
    let spectrum = spectrum(first)?;
    let plot = Plot {
        x: Axis::linear("frequency (Hz)"),
        y: Axis::log(format!("amplitude of {}", observed_axis(result).label)),
        series: std::iter::once(Series {
            label: "recorded".to_owned(),
            hue: Hue::Data,
            mark: Mark::Line,
            points: spectrum.clone(),
        })
        .chain(marked(&result.modes, &spectrum))
        .collect(),
        shaded: vec![],
    };
    let drawing = plot.draw("Spectrum: amplitude over frequency.")?;
    let which = if result.records.len() > 1 { "first record" } else { "record" };
    let explanation = format!(
        "Amplitude spectrum of the {which}, with a Hann window. {}",
        match result.modes.as_slice() {
            [] => "No second mode stands out of the noise.".to_owned(),
            modes => sentence(modes),
        }
    );
    let table = csv(&["frequency_hz", "amplitude"], &spectrum, |(frequency, amplitude): &(f64, f64)| {
        vec![number(*frequency), number(*amplitude)]
    });
    Some(framed("spectrum", "Spectrum".to_owned(), explanation, drawing, table))
}

/// Returns marks on a spectrum at the modes and at the steady lines, if there are some within it.
fn marked(modes: &[ModeRow], spectrum: &[(f64, f64)]) -> Vec<Series> {
    let point = |mode: &ModeRow| {
        let frequency = mode.frequency_hz.value;
        let from = spectrum.partition_point(|(line, _)| *line < frequency);
        spectrum.get(from).map(|(_, amplitude)| (frequency, *amplitude))
    };
    let of = |label: &str, hue: Hue, steady: bool| Series {
        label: label.to_owned(),
        hue,
        mark: Mark::Dots,
        points: modes.iter().filter(|mode| mode.steady == steady).filter_map(point).collect(),
    };
    let marks = [of("modes", Hue::Estimate, false), of("steady lines", Hue::Second, true)];
    marks.into_iter().filter(|series| !series.points.is_empty()).collect()
}

/// Returns frequencies in Hz and amplitudes, from one line over the record to a few times the strongest one.
fn spectrum(rows: &[SeriesRow]) -> Option<Vec<(f64, f64)>> {
    let stride = rows.len().div_ceil(MOST_SAMPLES).max(1);
    let count = rows.len() as f64;
    let mean = rows.iter().map(|row| row.observed).sum::<f64>() / count;
    let samples: Vec<(f64, f64)> = rows
        .chunks(stride)
        .map(|part| {
            let size = part.len() as f64;
            let time = part.iter().map(|row| row.time_s).sum::<f64>() / size;
            (time, part.iter().map(|row| row.observed).sum::<f64>() / size - mean)
        })
        .collect();
    let (start, end) = (samples.first()?.0, samples.last()?.0);
    let duration = end - start;
    let weighted: Vec<(f64, f64)> = samples
        .iter()
        .map(|(time, value)| {
            (*time, value * (1.0 - (TAU * (time - start) / duration).cos()) / samples.len() as f64)
        })
        .collect();
    let amplitude = |frequency: f64| {
        let parts = weighted.iter().fold((0.0, 0.0), |(cosine, sine), (time, value)| {
            let (s, c) = (TAU * frequency * time).sin_cos();
            (cosine + value * c, sine + value * s)
        });
        2.0 * parts.0.hypot(parts.1)
    };
    let nyquist = 0.5 * samples.len() as f64 / duration;
    let lines = |from: f64, to: f64, count: usize| -> Vec<(f64, f64)> {
        let place = |at: usize| from + (to - from) * at as f64 / count as f64;
        (0..=count).map(place).map(|frequency| (frequency, amplitude(frequency))).collect()
    };
    let lowest = 1.0 / duration;
    let coarse =
        lines(lowest, nyquist, (2.0 * duration * nyquist).clamp(2.0, 4.0 * MOST_LINES as f64) as usize);
    let strongest = coarse.iter().max_by(|one, other| one.1.total_cmp(&other.1))?.0;
    let found = lines(lowest, (HARMONICS * strongest).min(nyquist), MOST_LINES);
    (duration > 0.0 && found.iter().all(|(_, amplitude)| amplitude.is_finite())).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::spectrum;
    use results::SeriesRow;
    use std::f64::consts::TAU;

    #[test]
    fn a_sinusoid_has_its_amplitude_at_its_frequency() {
        let row = |at: usize| {
            let time_s = 0.01 * at as f64;
            let observed = 3.0 + 0.7 * (TAU * 2.0 * time_s).cos();
            let [nominal, recalibrated, repaired] = [observed; 3];
            SeriesRow {
                record: 1,
                segment: 1,
                time_s,
                observed,
                nominal,
                recalibrated,
                repaired,
                input_torque: None,
            }
        };
        let rows: Vec<SeriesRow> = (0..4000).map(row).collect();
        let found = spectrum(&rows).unwrap();
        let top = found.iter().max_by(|one, other| one.1.total_cmp(&other.1)).unwrap();
        assert!((top.0 - 2.0).abs() < 0.03 && (top.1 - 0.7).abs() < 0.05, "{top:?}");
    }
}
