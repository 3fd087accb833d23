use super::SamplesPipeline;
use envelope::EnvelopeError;
use rand_distr::{Distribution, Normal};
use record::{Clock, ClockChoice, Quantity, Record};
use seed::Seed;
use std::f64::consts::TAU;

fn record(rate: f64, duration: f64, noise: f64, seed: u64, motion: impl Fn(f64) -> f64) -> Record {
    let mut draws = Seed::new(seed).child("noise").generator();
    let normal = Normal::new(0.0, noise).unwrap();
    let times: Vec<f64> = (0..(rate * duration) as usize).map(|at| at as f64 / rate).collect();
    let values = times.iter().map(|time| motion(*time) + normal.sample(&mut draws)).collect();
    Record::new(times, values, None, Quantity::Position, "rad").unwrap()
}

/// Free decay from 1 at rest, of natural frequency 1 Hz.
fn decay(zeta: f64) -> impl Fn(f64) -> f64 {
    move |time| {
        let omega = TAU * (1.0 - zeta * zeta).sqrt();
        let slow = zeta / (1.0 - zeta * zeta).sqrt();
        (-zeta * TAU * time).exp() * ((omega * time).cos() + slow * (omega * time).sin())
    }
}

/// Returns frequency in Hz, damping ratio and its standard error.
fn found(record: &Record) -> Result<[f64; 3], EnvelopeError> {
    let clock = Clock::new(record, ClockChoice::Auto).unwrap();
    let extraction = SamplesPipeline::DEFAULT.extract(record, &clock)?;
    let fit = oracle::decay_rate(&extraction.envelope).unwrap();
    Ok([extraction.envelope.omega_rad_s().hypot(fit.decay_rate) / TAU, fit.zeta, fit.zeta_std_error])
}

#[test]
fn an_exact_decay_is_read_exactly() {
    for zeta in [0.003, 0.02, 0.1, 0.3, 0.6, 0.8] {
        let [frequency, ratio, _] = found(&record(100.0, 12.0, 0.0, 1, decay(zeta))).unwrap();
        assert!(
            (frequency - 1.0).abs() < 3e-4 && (ratio / zeta - 1.0).abs() < 3e-4,
            "{zeta}: {frequency} {ratio}"
        );
    }
}

#[test]
fn noise_moves_it_by_its_standard_errors() {
    for (rate, duration, noise, zeta) in [
        (100.0, 12.0, 0.125, 0.02),
        (12.0, 30.0, 0.01, 0.01),
        (200.0, 8.0, 0.005, 0.4),
        (100.0, 4.0, 1e-3, 0.6),
    ] {
        let far = (0..20).filter(|seed| {
            let [frequency, ratio, error] =
                found(&record(rate, duration, noise, *seed, decay(zeta))).unwrap();
            (ratio - zeta).abs() > 3.0 * error || (frequency - 1.0).abs() > 0.02
        });
        assert!(far.count() <= 2, "{zeta}");
    }
}

#[test]
fn another_mode_is_taken_away() {
    let beating = |time: f64| decay(0.01)(time) + 0.5 * decay(0.003)(1.13 * time) + 0.2;
    let [frequency, ratio, error] = found(&record(50.0, 60.0, 1e-3, 3, beating)).unwrap();
    assert!(
        (frequency - 1.0).abs() < 1e-3 && (ratio - 0.01).abs() < 3.0 * error + 1e-5,
        "{frequency} {ratio} {error}"
    );
}

#[test]
fn a_motion_without_a_swing_is_said() {
    let creeping = |time: f64| 1.2 * (-2.0 * time).exp() - 0.2 * (-12.0 * time).exp();
    assert_eq!(found(&record(100.0, 5.0, 1e-3, 1, creeping)), Err(EnvelopeError::NoSwing));
}

/// Noise as large as the swing hides it in windows of half a period, and not in longer ones.
#[test]
fn a_faint_swing_is_found_without_bias() {
    let pulls: Vec<[f64; 2]> = (0..12)
        .map(|seed| {
            let record = record(200.0, 20.0, 1.0, seed, decay(0.003));
            let found = crate::identify(&record, &Clock::new(&record, ClockChoice::Auto).unwrap()).unwrap();
            let (frequency, ratio) = (found.natural_frequency_hz().unwrap(), found.damping_ratio().unwrap());
            [(frequency.value - 1.0) / frequency.std_error, (ratio.value - 0.003) / ratio.std_error]
        })
        .collect();
    assert!(pulls.iter().flatten().filter(|pull| pull.abs() > 3.0).count() <= 1, "{pulls:?}");
}

/// Of a swing of a few steps, only what is large beside a step is believed.
#[test]
fn coarse_rounding_is_no_noise() {
    let fine = record(100.0, 100.0, 0.01, 4, |time| 5.0 * decay(0.004)(time));
    let record = fine.mapped(f64::round, |input| input).unwrap();
    let [frequency, ratio, error] = found(&record).unwrap();
    assert!(
        (frequency - 1.0).abs() < 1e-3 && (ratio - 0.004).abs() < 4.0 * error,
        "{frequency} {ratio} {error}"
    );
}
