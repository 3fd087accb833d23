//! Spectrum of a record, with its modes.

use results::{DiagnosisResult, SeriesRow};
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
    let samples: Vec<(f64, f64)> = first.iter().map(|row| (row.time_s, row.observed)).collect();
    let lines: Vec<(f64, bool)> =
        result.modes.iter().map(|mode| (mode.frequency_hz.value, mode.steady)).collect();
    let plot = plot(&samples, &lines, &observed_axis(result).label)?;
    let drawing = plot.draw("Spectrum: amplitude over frequency.")?;
    let which = if result.records.len() > 1 { "first record" } else { "record" };
    let explanation = format!(
        "Amplitude spectrum of the {which}, with a Hann window. {}",
        match result.modes.as_slice() {
            [] => "No second mode stands out of the noise.".to_owned(),
            modes => sentence(modes),
        }
    );
    let lines = plot.series.first().map(|series| series.points.as_slice()).unwrap_or_default();
    let table = csv(&["frequency_hz", "amplitude"], lines, |(frequency, amplitude): &(f64, f64)| {
        vec![number(*frequency), number(*amplitude)]
    });
    Some(framed("spectrum", "Spectrum".to_owned(), explanation, drawing, table))
}

/// Returns the plot of the amplitude spectrum of samples (times in seconds, values), with a Hann window, and a dot at each of the
/// `lines` by its frequency in Hz: a mode or, where its flag says so, a steady line. `label` names the values with their unit.
/// `None` for samples without a spectrum.
#[must_use]
pub fn plot(samples: &[(f64, f64)], lines: &[(f64, bool)], label: &str) -> Option<Plot> {
    let highest = lines.iter().map(|line| line.0).fold(f64::NAN, f64::max);
    let found = spectrum(samples, Some(highest).filter(|highest| *highest > 0.0))?;
    let nearest = |line: &(f64, bool)| {
        let off = |own: &&(f64, f64)| (own.0 - line.0).abs();
        let own = found.iter().min_by(|one, other| off(one).total_cmp(&off(other)))?;
        Some((line.0, own.1))
    };
    let series = |label: &str, hue, mark, points| Series { label: label.to_owned(), hue, mark, points };
    let marked = |label: &str, hue: Hue, steady: bool| {
        let points: Vec<_> = lines.iter().filter(|line| line.1 == steady).filter_map(nearest).collect();
        (!points.is_empty()).then(|| series(label, hue, Mark::Dots, points))
    };
    let marks = [marked("modes", Hue::Oracle, false), marked("steady lines", Hue::Second, true)];
    let recorded = series("recorded", Hue::Data, Mark::Line, found.clone());
    Some(Plot {
        x: Axis::linear("frequency (Hz)"),
        y: Axis::log(format!("amplitude of {label}")),
        series: std::iter::once(recorded).chain(marks.into_iter().flatten()).collect(),
        shaded: vec![],
    })
}

/// Returns frequencies in Hz and amplitudes, from one line over the record to a few times the strongest one, which is
/// searched for unless a frequency to begin with is known.
fn spectrum(rows: &[(f64, f64)], known_hz: Option<f64>) -> Option<Vec<(f64, f64)>> {
    let stride = rows.len().div_ceil(MOST_SAMPLES).max(1);
    let count = rows.len() as f64;
    let mean = rows.iter().map(|row| row.1).sum::<f64>() / count;
    let samples: Vec<(f64, f64)> = rows
        .chunks(stride)
        .map(|part| {
            let size = part.len() as f64;
            let time = part.iter().map(|row| row.0).sum::<f64>() / size;
            (time, part.iter().map(|row| row.1).sum::<f64>() / size - mean)
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
    let nyquist = 0.5 * samples.len() as f64 / duration;
    let lines = |from: f64, to: f64, count: usize| -> Vec<(f64, f64)> {
        let step = (to - from) / count as f64;
        let amplitudes = amplitudes(&weighted, from, step, count + 1);
        (0..=count).map(|at| from + step * at as f64).zip(amplitudes).collect()
    };
    let lowest = 1.0 / duration;
    let searched = || {
        let count = (2.0 * duration * nyquist).clamp(2.0, 4.0 * MOST_LINES as f64) as usize;
        let coarse = lines(lowest, nyquist, count);
        Some(coarse.iter().max_by(|one, other| one.1.total_cmp(&other.1))?.0)
    };
    let strongest = known_hz.or_else(searched)?;
    let found = lines(lowest, (HARMONICS * strongest).min(nyquist), MOST_LINES);
    (duration > 0.0 && found.iter().all(|(_, amplitude)| amplitude.is_finite())).then_some(found)
}

/// Returns the amplitudes at `count` frequencies in Hz, `step` apart, of samples (times, values multiplied with weights that
/// sum to 1). The phasor of each sample is rotated from one frequency to the next.
fn amplitudes(weighted: &[(f64, f64)], lowest: f64, step: f64, count: usize) -> Vec<f64> {
    let turned = |frequency: f64| weighted.iter().map(move |(time, _)| (TAU * frequency * time).sin_cos());
    let mut phasors: Vec<(f64, f64)> = turned(lowest).collect();
    let turns: Vec<(f64, f64)> = turned(step).collect();
    let amplitude = |_| {
        let (mut sine, mut cosine) = (0.0, 0.0);
        for (((s, c), (ahead, along)), (_, value)) in phasors.iter_mut().zip(&turns).zip(weighted) {
            sine += value * *s;
            cosine += value * *c;
            (*s, *c) = (*s * along + *c * ahead, *c * along - *s * ahead);
        }
        2.0 * f64::hypot(sine, cosine)
    };
    (0..count).map(amplitude).collect()
}

#[cfg(test)]
mod tests {
    use super::plot;
    use std::f64::consts::TAU;

    #[test]
    fn a_sinusoid_has_its_amplitude_at_its_frequency_and_modes_are_marked() {
        let sample = |at: usize| {
            let time = 0.01 * at as f64;
            (time, 3.0 + 0.7 * (TAU * 2.0 * time).cos())
        };
        let samples: Vec<(f64, f64)> = (0..4000).map(sample).collect();
        for modes in [&[][..], &[(2.0, false)], &[(2.0, false), (2.1, true)]] {
            let drawn = plot(&samples, modes, "angle (rad)").unwrap();
            let lines = &drawn.series[0].points;
            let top = lines.iter().max_by(|one, other| one.1.total_cmp(&other.1)).unwrap();
            assert!((top.0 - 2.0).abs() < 0.03 && (top.1 - 0.7).abs() < 0.05, "{top:?}");
            let marks: Vec<&str> = drawn.series[1..].iter().map(|own| own.label.as_str()).collect();
            assert_eq!(marks, &["modes", "steady lines"][..modes.len()]);
        }
    }
}
