use super::{Mode, modes};
use crate::Estimated;
use rand_distr::{Distribution, Normal};
use record::{Clock, ClockChoice, Quantity, Record};
use seed::Seed;
use std::f64::consts::TAU;

const SEEDS: u64 = 3;

/// Frequency in Hz, damping ratio, amplitude and phase.
type Truth = (f64, f64, f64, f64);

fn even(count: usize, rate: f64) -> Vec<f64> {
    (0..count).map(|at| at as f64 / rate).collect()
}

/// Values at times with white noise.
fn noisy(values: impl Iterator<Item = f64>, noise: f64, seed: u64) -> Vec<f64> {
    let mut draws = Seed::new(seed).child("noise").generator();
    let normal = Normal::new(0.0, noise).unwrap();
    values.map(|value| value + normal.sample(&mut draws)).collect()
}

fn sum(truths: &[Truth], time: f64) -> f64 {
    let one = |&(frequency, ratio, amplitude, phase): &Truth| {
        let natural = TAU * frequency;
        let damped = natural * (1.0 - ratio * ratio).sqrt();
        amplitude * (-ratio * natural * time).exp() * (damped * time + phase).cos()
    };
    truths.iter().map(one).sum()
}

fn found(times: Vec<f64>, values: Vec<f64>) -> Vec<Mode> {
    let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
    modes(&record, &Clock::new(&record, ClockChoice::Auto).unwrap())
}

/// A swing from rest at an angle under an acceleration of angle and velocity, by the midpoint rule.
fn swing(start: f64, times: &[f64], acceleration: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let (mut x, mut v, mut now) = (start, 0.0, 0.0);
    let mut values = Vec::new();
    for &time in times {
        while now < time - 1e-12 {
            let step = (time - now).min(1e-3);
            let (xm, vm) = (x + 0.5 * step * v, v + 0.5 * step * acceleration(x, v));
            x += step * vm;
            v += step * acceleration(xm, vm);
            now += step;
        }
        values.push(x);
    }
    values
}

fn within(found: Estimated, truth: f64) -> bool {
    (found.value - truth).abs() <= 3.0 * found.std_error
}

/// Counts the seeds for which all modes are found, and how many of their numbers are within 3 errors.
fn score(truths: &[Truth], times: &[f64], noise: f64) -> (u64, usize, usize) {
    let (mut right, mut near, mut all) = (0, 0, 0);
    for seed in 0..SEEDS {
        let mut truths = truths.to_vec();
        for (number, truth) in truths.iter_mut().enumerate() {
            truth.3 += (seed * 7 + number as u64 * 3) as f64;
        }
        let values = noisy(times.iter().map(|time| 0.2 + sum(&truths, *time)), noise, seed);
        let mut modes = found(times.to_vec(), values);
        if modes.len() != truths.len() {
            continue;
        }
        right += 1;
        modes.sort_by(|one, other| one.frequency_hz.value.total_cmp(&other.frequency_hz.value));
        for (mode, truth) in modes.iter().zip(&truths) {
            let inside = [within(mode.frequency_hz, truth.0), within(mode.damping_ratio, truth.1)];
            near += inside.iter().filter(|inside| **inside).count();
            all += 2;
            assert!((mode.frequency_hz.value - truth.0).abs() < 0.02 * truth.0, "{mode:?}");
            assert!((mode.amplitude - truth.2).abs() < 0.1 * truth.2, "{mode:?}");
        }
        assert!((modes.iter().map(|mode| mode.share).sum::<f64>() - 1.0).abs() < 1e-9);
    }
    (right, near, all)
}

fn assert_found(truths: &[Truth], times: &[f64], noise: f64) {
    let (right, near, all) = score(truths, times, noise);
    assert_eq!(right, SEEDS, "{truths:?}");
    assert!(near as f64 >= 0.9 * all as f64, "{near} of {all} within three errors: {truths:?}");
}

#[test]
fn one_mode_is_found_with_honest_errors() {
    for ratio in [0.0005, 0.01, 0.05, 0.2] {
        assert_found(&[(2.0, ratio, 1.0, 0.3)], &even(3000, 100.0), 0.01);
    }
    assert_found(&[(0.31, 0.02, 1.0, 0.3)], &even(400, 20.0), 0.05);
    assert_found(&[(31.0, 0.004, 1.0, 0.3)], &even(4000, 100.0), 0.2);
}

#[test]
fn two_modes_are_found_with_honest_errors() {
    assert_found(&[(1.0, 0.01, 1.0, 0.0), (2.7, 0.01, 0.3, 1.0)], &even(3000, 100.0), 0.01);
    assert_found(&[(1.0, 0.05, 1.0, 0.0), (2.7, 0.05, 0.3, 1.0)], &even(3000, 100.0), 0.01);
    assert_found(&[(1.0, 0.002, 1.0, 0.0), (1.1, 0.004, 0.8, 1.0)], &even(6000, 100.0), 0.02);
    assert_found(&[(0.509, 0.0015, 1.0, 0.0), (0.539, 0.0001, 1.0, 1.0)], &even(3000, 10.0), 0.05);
    assert_found(&[(1.0, 0.005, 1.0, 0.0), (1.3, 0.005, 0.1, 1.0)], &even(6000, 100.0), 0.01);
    assert_found(&[(2.0, 0.003, 0.05, 0.0), (17.0, 0.001, 1.0, 1.0)], &even(6000, 100.0), 0.01);
}

#[test]
fn three_modes_are_found_with_honest_errors() {
    let truths = [(0.7, 0.01, 1.0, 0.0), (1.9, 0.005, 0.5, 1.0), (4.3, 0.01, 0.3, 2.0)];
    assert_found(&truths, &even(4000, 100.0), 0.01);
    let close = [(0.7, 0.001, 1.0, 0.0), (0.77, 0.001, 0.5, 1.0), (0.83, 0.001, 0.7, 2.0)];
    assert_found(&close, &even(12_000, 100.0), 0.02);
}

#[test]
fn uneven_stamps_are_used_as_they_are() {
    let mut draws = Seed::new(5).child("stamps").generator();
    let normal = Normal::new(0.0, 0.3).unwrap();
    let mut times: Vec<f64> = (0..4000)
        .filter(|at| !(1500..1700).contains(at))
        .map(|at| 0.02 * (f64::from(at) + normal.sample(&mut draws)))
        .collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    assert_found(&[(1.0, 0.004, 1.0, 0.0), (2.7, 0.002, 0.3, 1.0)], &times, 0.02);
}

fn assert_single(name: &str, frequency: f64, times: &[f64], clean: &[f64], noise: f64) {
    for seed in 0..2 {
        let values = noisy(clean.iter().copied(), noise, seed);
        let modes = found(times.to_vec(), values);
        assert_eq!(modes.len(), 1, "{name}, noise {noise}, seed {seed}: {modes:?}");
        assert!((modes[0].frequency_hz.value / frequency - 1.0).abs() < 0.1, "{name} {modes:?}");
    }
}

#[test]
fn a_nonlinear_swing_is_one_mode() {
    let omega = TAU;
    let times = even(6000, 100.0);
    for noise in [1e-9, 1e-3, 1e-2] {
        let coulomb = swing(1.0, &times, |x, v| -omega * omega * (x + 0.01 * (v * 50.0).tanh()) - 0.02 * v);
        assert_single("Coulomb", 1.0, &times, &coulomb, noise);
        let slight = swing(1.0, &times, |x, v| -omega * omega * (x + 0.002 * (v * 50.0).tanh()) - 0.05 * v);
        assert_single("slight Coulomb", 1.0, &times, &slight, noise);
        let drag = swing(1.0, &times, |x, v| -omega * omega * x - 0.1 * v * v.abs() - 0.01 * v);
        assert_single("drag", 1.0, &times, &drag, noise);
        for damping in [0.01, 0.05, 0.3] {
            let pendulum = swing(1.0, &times, |x, v| -omega * omega * x.sin() - damping * v);
            assert_single(&format!("pendulum {damping}"), 1.0, &times, &pendulum, noise);
        }
        let hardening = swing(1.0, &times, |x, v| -omega * omega * (x + 0.3 * x.powi(3)) - 0.1 * v);
        assert_single("hardening", 1.05, &times, &hardening, noise);
        let both = swing(1.5, &times, |x, v| {
            -omega * omega * (x.sin() + 0.01 * (v * 50.0).tanh()) - 0.05 * v * v.abs()
        });
        assert_single("pendulum, drag and Coulomb", 1.0, &times, &both, noise);
    }
}

/// The frequency changes by many widths of the line, so that one line leaves most of the swing and two lines
/// fit far better.
#[test]
fn a_long_chirp_is_one_mode() {
    let times = even(7000, 20.0);
    let hardening = swing(1.0, &times, |x, v| -TAU * TAU * (x + 0.12 * x.powi(3)) - 0.0112 * v);
    assert_single("hardening", 1.0, &times, &hardening, 1e-3);
    let gap = |x: f64| if x.abs() < 0.05 { 0.05 * x } else { x - 0.95 * 0.05 * x.signum() };
    let play = swing(1.0, &times, |x, v| -TAU * TAU * gap(x) - 0.0022 * v - 0.003 * v * v.abs());
    assert_single("play", 0.95, &times, &play, 1e-3);
}

#[test]
fn a_swing_with_sensor_effects_is_one_mode() {
    let times = even(6000, 100.0);
    let clean: Vec<f64> = times.iter().map(|time| sum(&[(1.0, 0.01, 1.0, 0.0)], *time)).collect();
    let quantized: Vec<f64> = clean.iter().map(|value| (value * 50.0).round() / 50.0).collect();
    assert_single("quantized", 1.0, &times, &quantized, 1e-9);
    let line: Vec<f64> = clean.iter().zip(&times).map(|(value, time)| value + 0.01 * time).collect();
    assert_single("line", 1.0, &times, &line, 1e-3);
    let warming: Vec<f64> =
        clean.iter().zip(&times).map(|(x, time)| x - 0.3 * (-time / 20.0).exp()).collect();
    assert_single("warming", 1.0, &times, &warming, 1e-3);
    for seed in 0..SEEDS {
        let steps = noisy(clean.iter().map(|_| 0.0), 2e-3, 100 + seed);
        let mut level = 0.0;
        let walk: Vec<f64> = clean
            .iter()
            .zip(&steps)
            .map(|(value, step)| {
                level += step;
                value + level
            })
            .collect();
        assert_single("random walk", 1.0, &times, &walk, 1e-3);
    }
}

#[test]
fn noise_has_no_modes() {
    for seed in 0..6 {
        let times = even(3000, 100.0);
        let white = noisy(times.iter().map(|_| 0.0), 1.0, seed);
        let mut level = 0.0;
        let walk: Vec<f64> = white
            .iter()
            .map(|step| {
                level += step;
                level
            })
            .collect();
        assert_eq!(found(times.clone(), white), Vec::new(), "white {seed}");
        assert_eq!(found(times, walk), Vec::new(), "walk {seed}");
    }
}

#[test]
fn a_harmonic_is_no_mode() {
    let times = even(6000, 100.0);
    let truths = [(1.0, 0.01, 1.0, 0.0), (3.0, 0.03, 0.1, 1.0), (2.4, 0.01, 0.1, 1.0)];
    for seed in 0..SEEDS {
        let values = noisy(times.iter().map(|time| sum(&truths, *time)), 1e-3, seed);
        let modes = found(times.clone(), values);
        let frequencies: Vec<i64> =
            modes.iter().map(|mode| (100.0 * mode.frequency_hz.value).round() as i64).collect();
        assert_eq!(frequencies, [100, 240], "{modes:?}");
    }
}

#[test]
fn what_does_not_move_or_is_driven_has_no_modes() {
    let times = even(500, 100.0);
    let values: Vec<f64> = times.iter().map(|time| sum(&[(3.0, 0.01, 1.0, 0.0)], *time)).collect();
    assert_eq!(found(times.clone(), vec![0.3; 500]), Vec::new());
    assert_eq!(found(times[..10].to_vec(), values[..10].to_vec()), Vec::new());
    let driven = Record::new(times.clone(), values, Some(times), Quantity::Position, "rad").unwrap();
    assert_eq!(modes(&driven, &Clock::new(&driven, ClockChoice::Auto).unwrap()), Vec::new());
}

/// The run time of a long record is far from quadratic.
#[test]
fn a_long_record_takes_seconds() {
    let times = even(100_000, 100.0);
    let truths = [(1.0, 0.0003, 1.0, 0.0), (2.7, 0.0003, 0.3, 1.0)];
    let values = noisy(times.iter().map(|time| sum(&truths, *time)), 0.01, 1);
    let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
    let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
    let started = std::time::Instant::now();
    assert_eq!(modes(&record, &clock).len(), 2);
    let elapsed = started.elapsed();
    assert!(elapsed.as_secs() < 30, "{elapsed:?}");
}

/// Regression: a hum was called a mode, and a strong one the first.
#[test]
fn a_line_that_keeps_its_amplitude_beside_a_decay_is_no_mode() {
    let times = even(6000, 1000.0);
    let of = |truths: &[Truth]| {
        let values = noisy(times.iter().map(|time| sum(truths, *time)), 0.01, 4);
        found(times.clone(), values)
    };
    // Also at twice the frequency, where a harmonic of the swing would decay with it.
    for (line, hum) in [(50.0, 0.15), (50.0, 0.6), (34.03, 0.3)] {
        let found = of(&[(17.0, 0.01, 1.0, 0.3), (line, 0.0, hum, 1.0)]);
        assert_eq!(found.iter().map(|mode| mode.is_steady).collect::<Vec<_>>(), [false, true], "{found:?}");
        assert!(within(found[0].damping_ratio, 0.01), "{found:?}");
    }
    let slow = of(&[(17.0, 0.01, 1.0, 0.3), (50.0, 0.0005, 0.3, 1.0)]);
    assert!(slow.len() == 2 && slow.iter().all(|mode| !mode.is_steady), "{slow:?}");
    assert!(of(&[(17.0, 0.0, 1.0, 0.3)]).iter().all(|mode| !mode.is_steady));
}
