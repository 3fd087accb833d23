//! Tests of records with gaps: samples on both sides of a gap never count as neighbors.

use crate::{Extraction, PaperPipeline, RecommendedPipeline};
use record::{Clock, ClockChoice, CsvColumns, Missing, ReadOptions, read_text};

const LAMBDA: f64 = 0.13;
const NOISE: f64 = 1e-3;

/// Returns pseudo-random numbers of standard deviation 1 without a generator: the sum of twelve uniform ones
/// minus six.
fn noise(index: u32) -> f64 {
    let uniform = |at: u32| (f64::from(at) * 12.9898).sin().mul_add(43_758.545_3, 0.0).rem_euclid(1.0);
    (0..12).map(|part| uniform(12 * index + part)).sum::<f64>() - 6.0
}

/// Returns 20 s of a decay at 200 samples per second, with a third of a second without numbers from `start`
/// on.
fn text(omega: f64, start: f64) -> String {
    (0..4000).fold("angle_rad\n".to_owned(), |text, index| {
        let time = f64::from(index) / 200.0;
        let angle = 0.6 * (-LAMBDA * time).exp() * (omega * time).cos() + NOISE * noise(index);
        let hole = time >= start && time < start + 1.0 / 3.0;
        text + &if hole { "NaN\n".to_owned() } else { format!("{angle:.7}\n") }
    })
}

fn extract(
    text: &str,
    missing: Missing,
    choice: ClockChoice,
    pipeline: &dyn Fn(&record::Record, &Clock) -> Extraction,
) -> Extraction {
    let columns = CsvColumns { missing, sample_rate_hz: Some(200.0), ..CsvColumns::default() };
    let options = ReadOptions { columns, ..ReadOptions::default() };
    let (record, _) = read_text("r.csv", text.as_bytes(), &options).unwrap();
    pipeline(&record, &Clock::new(&record, choice).unwrap())
}

fn recommended(record: &record::Record, clock: &Clock) -> Extraction {
    RecommendedPipeline::DEFAULT.extract(record, clock).unwrap()
}

fn paper(record: &record::Record, clock: &Clock) -> Extraction {
    let pipeline = PaperPipeline {
        interpolation_step_s: 0.005,
        smoothing_window: 11,
        smoothing_order: 3,
        late_fraction: 0.1,
        peak_distance: 20,
        prominence: 0.02,
    };
    pipeline.extract(record, clock).unwrap()
}

/// Returns the decay rate with its standard error by least squares, and the largest distance of a peak from
/// that line.
fn line(found: &Extraction) -> (f64, f64, f64) {
    let (times, logs) = (found.envelope.times_s(), found.envelope.log_amplitudes());
    let count = times.len() as f64;
    let (mean_t, mean_y) = (times.iter().sum::<f64>() / count, logs.iter().sum::<f64>() / count);
    let spread: f64 = times.iter().map(|t| (t - mean_t).powi(2)).sum();
    let slope = times.iter().zip(logs).map(|(t, y)| (t - mean_t) * (y - mean_y)).sum::<f64>() / spread;
    let left: Vec<f64> = times.iter().zip(logs).map(|(t, y)| y - mean_y - slope * (t - mean_t)).collect();
    let error = (left.iter().map(|r| r * r).sum::<f64>() / (count - 2.0) / spread).sqrt();
    (-slope, error, left.iter().fold(0.0, |most, r| f64::max(most, r.abs())))
}

/// The gap is tested at twelve phases of slow and fast swings.
#[test]
fn a_gap_makes_no_peak_and_moves_none() {
    type Pipeline = fn(&record::Record, &Clock) -> Extraction;
    let pipelines: [(&str, f64, Pipeline); 2] = [("recommended", 2e-3, recommended), ("paper", 1e-2, paper)];
    for (omega, (name, near, pipeline)) in
        [5.0, 8.0, 21.7].into_iter().flat_map(|o| pipelines.map(|p| (o, p)))
    {
        for choice in [ClockChoice::Auto, ClockChoice::UniformIndex] {
            let whole = line(&extract(&text(omega, f64::INFINITY), Missing::Segment, choice, &pipeline)).0;
            for phase in 0..12 {
                let text = text(omega, 4.0 + f64::from(phase) / 6.0 * std::f64::consts::PI / omega);
                let found = extract(&text, Missing::Segment, choice, &pipeline);
                let about = format!("{name} {choice:?} ω = {omega}, phase {phase}");
                let (rate, error, largest) = line(&found);
                assert!(
                    (rate - whole).abs() < f64::max(2.0 * error, near * whole),
                    "{about}: {rate} ± {error}, without the gap {whole}"
                );
                assert!(error < 2e-3 && largest < 0.05, "{about}: {error} {largest}");
                let omega_found = found.envelope.omega_rad_s();
                assert!((omega_found / omega - 1.0).abs() < near, "{about}: {omega_found}");
                let span = found.envelope.duration_s();
                assert!(span > 14.0, "{about}: the decay goes on beyond the gap, {span}");
            }
        }
    }
}

/// Dropped rows leave no gap: with even sampling the samples after them move a third of a second earlier.
#[test]
fn dropped_rows_close_up() {
    let text = text(8.0, 4.0);
    let of = |missing| extract(&text, missing, ClockChoice::UniformIndex, &recommended).envelope.duration_s();
    let (segment, drop) = (of(Missing::Segment), of(Missing::Drop));
    assert!((segment - drop - 1.0 / 3.0).abs() < 0.05, "{segment} {drop}");
}

/// A log whose second half is filled up with zeros: the noise was once taken as zero, and every wiggle as a
/// swing.
#[test]
fn a_log_filled_up_with_zeros_has_the_noise_of_its_moving_part() {
    let text = (0..12_000).fold("angle_rad\n".to_owned(), |text, index| {
        let time = f64::from(index) / 200.0;
        let swing = 0.6 * (-0.6 * time).exp() * (8.0 * time).cos() + NOISE * noise(index);
        text + &format!("{:.6}\n", if index < 4000 { swing } else { 0.0 })
    });
    let found = extract(&text, Missing::Segment, ClockChoice::Auto, &recommended);
    let (rate, error, _) = line(&found);
    assert!((rate - 0.6).abs() < 4.0 * error && error < 0.01, "{rate} ± {error}");
    assert!((found.envelope.omega_rad_s() / 8.0 - 1.0).abs() < 5e-3, "{}", found.envelope.omega_rad_s());
}
